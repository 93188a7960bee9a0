#include "pipeline/figures/gallery.h"

#include <charconv>

#include "pipeline/figures/canvas.h"
#include "pipeline/progress.h"
#include "reports/text.h"

namespace morphodesic::pipeline {

const std::vector<FigureKind>& figure_kinds() {
    static const std::vector<FigureKind> kinds{
        {"1", "letters A to B and a cat-like to a lion-like solid", figure_letters_and_solids},
        {"2", "straight to rolled-up bar with 1, 2, 4 and 8 time steps", figure_bars},
        {"3", "discrete geodesics on the sphere: one level against the cascade", figure_sphere},
        {"4", "a pair that stretches and a pair that bends and keeps lengths", figure_isometry},
        {"5", "dumbbells: compression against transport", figure_dumbbells},
        {"6", "the solids with a slicing plane", figure_sliced_solids},
        {"7", "X to M with cracks, and with a contour length term and area preservation", figure_cracks},
        {"8", "a matchstick man with an arm and a leg partly hidden", figure_occlusion},
        {"9", "distance matrices of letters and of feet", figure_matrices},
        {"convergence", "path length against time steps and grid size", figure_convergence},
        {"accuracy", "convergence report: closed forms in 2D and 3D, time steps, reversed and moved pairs",
         figure_accuracy},
        {"two-geodesics", "a lower and a higher geodesic from A to B", figure_two_geodesics},
        {"disk", "concentric disks and their closed form", figure_disk},
        {"animation", "the path from A to B between its time steps", figure_animation},
    };
    return kinds;
}

std::string gallery_page(const std::vector<Figure>& figures, bool quick) {
    using reports::escape_markup;
    double seconds = 0;
    for (const Figure& figure : figures) seconds += figure.seconds;
    std::string page =
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>Morphodesic: "
        "figures</title>\n"
        "<style>\nbody{font:16px/1.5 Helvetica,Arial,'DejaVu Sans',sans-serif;color:#1b2430;background:#fff;max-width:"
        "1100px;margin:2em auto;padding:0 1em}\nimg{max-width:100%;height:auto;border:1px solid #e1e5ea}\n"
        "table{border-collapse:collapse;font-size:14px}td,th{border-bottom:1px solid #e1e5ea;padding:.25em .8em .25em "
        "0;"
        "text-align:left}\n.miss{color:#a02c1c;font-weight:bold}.time{color:#5b6573;font-size:14px}\n"
        "section{margin:3em 0}\n</style></head><body>\n<h1>Figures</h1>\n<p>Computed by <code>morphodesic figures" +
        std::string(quick ? " --quick" : "") + "</code> in " + escape_markup(duration_text(seconds)) +
        " from shapes that the program makes itself. Figure numbers are those of Wirth, Bar, Rumpf and Sapiro, "
        "Geodesics "
        "in Shape Space via Variational Time Discretization. The numbers behind each figure are in its CSV file.</p>\n"
        "<ul>\n";
    for (const Figure& figure : figures) {
        page += "<li><a href=\"#" + figure.name + "\">" + escape_markup(figure.name) +
                "</a>: " + escape_markup(figure.title) + " <span class=\"time\">" +
                escape_markup(duration_text(figure.seconds)) + "</span></li>\n";
    }
    page += "</ul>\n";
    for (const Figure& figure : figures) {
        page += "<section id=\"" + figure.name + "\"><h2>" + escape_markup(figure.title) + "</h2>\n<a href=\"" +
                figure.name + ".svg\"><img src=\"" + figure.name + ".png\" alt=\"" + escape_markup(figure.title) +
                "\"></a>\n<p>" + escape_markup(figure.caption) + "</p>\n";
        for (const FigureFile& file : figure.files) {
            if (file.name.ends_with(".webp")) {
                page += "<p><img src=\"" + file.name + "\" alt=\"" + escape_markup(file.name) + "\"></p>\n";
            }
        }
        page += "<table><tr><th>quantity</th><th>value</th><th>wanted</th><th></th><th>why</th></tr>\n";
        for (const FigureCheck& check : figure.checks) {
            page += "<tr><td>" + escape_markup(check.what) + "</td><td>" + escape_markup(check.value) + "</td><td>" +
                    escape_markup(check.wanted) + "</td><td>" +
                    (check.met ? "met" : "<span class=\"miss\">not met</span>") + "</td><td>" +
                    escape_markup(check.reason) + "</td></tr>\n";
        }
        page += "</table>\n<p class=\"time\">Computed in " + escape_markup(duration_text(figure.seconds)) +
                ". <a href=\"" + figure.name + ".png\">PNG</a> <a href=\"" + figure.name + ".svg\">SVG</a> <a href=\"" +
                figure.name + ".csv\">CSV</a>";
        for (const FigureFile& file : figure.files)
            page += " <a href=\"" + file.name + "\">" + escape_markup(file.name) + "</a>";
        page += "</p>\n</section>\n";
    }
    return page + "</body></html>\n";
}

namespace {

std::string markdown_row(const std::vector<std::string>& cells) {
    std::string text = "|";
    for (const std::string& cell : cells) text += " " + cell + " |";
    return text + "\n";
}

/// Numbers with a point lose the digits nobody reads.
std::string short_number(const std::string& cell) {
    double value = 0.0;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    const bool whole = error == std::errc() && end == cell.data() + cell.size();
    return whole && cell.find_first_of(".e") != std::string::npos ? rounded(value, 4) : cell;
}

}  // namespace

std::string gallery_markdown(const std::vector<Figure>& figures, const std::string& command) {
    std::string page = "Made by `" + command + "`.\n";
    for (const Figure& figure : figures) {
        page += "\n# " + figure.title + "\n\n![" + figure.title + "](" + figure.name + ".svg)\n\n" + figure.caption +
                "\n\n";
        page += markdown_row({"quantity", "value", "wanted", "", "why"}) +
                markdown_row({"---", "---", "---", "---", "---"});
        for (const FigureCheck& check : figure.checks) {
            page +=
                markdown_row({check.what, check.value, check.wanted, check.met ? "met" : "**not met**", check.reason});
        }
        page += "\n" + markdown_row(figure.numbers.columns) +
                markdown_row(std::vector<std::string>(figure.numbers.columns.size(), "---"));
        for (const auto& row : figure.numbers.rows) {
            std::vector<std::string> cells;
            for (const std::string& cell : row) cells.push_back(short_number(cell));
            page += markdown_row(cells);
        }
    }
    return page;
}

}  // namespace morphodesic::pipeline

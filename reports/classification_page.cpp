#include "reports/classification_page.h"

#include <algorithm>
#include <cmath>

#include "reports/assets.h"
#include "reports/svg.h"
#include "reports/text.h"

namespace morphodesic::reports {
namespace {

constexpr std::size_t rows_shown = 12;

constexpr std::string_view own_style = R"(
.query { border-top: 1px solid var(--line); padding-top: 1rem; display: grid; grid-template-columns: 220px minmax(0, 1fr); gap: 1rem 2rem; }
.query > div { min-width: 0; }
.query img.shape { width: 200px; height: 200px; background: var(--plate); border-radius: 6px; }
.film { display: flex; flex-wrap: wrap; gap: 4px; align-items: flex-end; margin: .2rem 0 1rem; }
.film figure { margin: 0; text-align: center; font-size: .75rem; color: var(--soft); }
.film img { width: 104px; height: 104px; background: var(--plate); border-radius: 4px; display: block; }
.film + .colour-bar { max-width: 420px; margin-top: -.6rem; }
.wrong { color: var(--accent); }
.hit { background: rgb(var(--share-ink) / .18); }
.miss { background: rgb(var(--wrong-ink) / .22); }
@media (max-width: 700px) { .query { grid-template-columns: 1fr; } }
)";

std::string image(const Picture& picture, const std::string& kind, const std::string& alt) {
    if (picture.bytes.empty()) return "";
    return "<img class=\"" + kind + "\" src=\"" + data_uri(picture.bytes) + "\" alt=\"" +
           escape_markup(picture.alt.empty() ? alt : picture.alt) + "\">";
}

std::string confusion_table(const ClassificationPage& page) {
    std::string html =
        "<section id=\"confusion\"><h2>Confusion matrix</h2><div class=\"scroll\"><table><thead><tr>"
        "<th scope=\"col\">true class</th>";
    for (const auto& name : page.classes) html += "<th scope=\"col\" class=\"num\">" + escape_markup(name) + "</th>";
    html += "</tr></thead><tbody>";
    for (std::size_t i = 0; i < page.confusion.size(); ++i) {
        html += "<tr><th scope=\"row\">" + escape_markup(page.classes[i]) + "</th>";
        for (std::size_t j = 0; j < page.classes.size(); ++j) {
            const int n = page.confusion[i][j];
            html += std::string("<td class=\"num") +
                    (n == 0   ? ""
                     : i == j ? " hit"
                              : " miss") +
                    "\">" + (n == 0 ? "" : std::to_string(n)) + "</td>";
        }
        html += "</tr>";
    }
    return html + "</tbody></table></div></section>\n";
}

std::string colour_bar(const ColourBar& bar) {
    if (bar.colours.empty()) return "";
    std::string ramp;
    for (const std::string& colour : bar.colours) ramp += (ramp.empty() ? "" : ", ") + colour;
    return "<div class=\"colour-bar\"><span>" + escape_markup(bar.quantity + " [" + bar.unit + "]") +
           "</span><span class=\"ramp\"><span>" + short_number(bar.low, 3) +
           "</span><i style=\"background:linear-gradient(to right, " + escape_markup(ramp) + ")\"></i><span>" +
           short_number(bar.high, 3) + "</span></span></div>";
}

std::string query_section(const ClassifiedQuery& q, std::size_t number) {
    std::string html = "<section class=\"query\" id=\"query-" + std::to_string(number) + "\"><div>";
    html += image(q.picture, "shape", q.name + ": what is visible; grey is hidden");
    html += "<p class=\"hint\">Dark: visible. Hatched: unknown.</p></div><div><h2>" + escape_markup(q.name) + "</h2>";
    html += std::string("<p class=\"headline") + (q.right ? "" : " wrong") + "\">" + escape_markup(q.verdict) + "</p>";
    html += "<dl class=\"facts\">";
    for (const auto& [what, value] : q.facts) {
        html += "<div><dt>" + escape_markup(what) + "</dt><dd>" + escape_markup(value) + "</dd></div>";
    }
    html += "</dl>";
    for (const auto& note : q.notes) html += "<p class=\"notice\">" + escape_markup(note) + "</p>";
    for (const auto& strip : q.strips) {
        html += "<h3>" + escape_markup(strip.title) + "</h3><div class=\"film\">";
        for (std::size_t k = 0; k < strip.frames.size(); ++k) {
            const std::string place = k == 0                         ? "query, placed"
                                      : k + 1 == strip.frames.size() ? "template"
                                                                     : "step " + std::to_string(k);
            html += "<figure>" + image(strip.frames[k], "frame", place) + place + "</figure>";
        }
        if (!strip.inferred.bytes.empty()) {
            html += "<figure>" + image(strip.inferred, "inferred", "orange: inferred where the query is hidden") +
                    "inferred (orange)</figure>";
        }
        html += "</div>" + colour_bar(strip.colour_bar);
    }
    html +=
        "<div class=\"scroll\"><table><caption>Nearest templates</caption><thead><tr><th>template</th><th>class</th>"
        "<th class=\"num\">distance</th><th class=\"num\">error bar</th><th class=\"num\">hidden</th></tr></thead>"
        "<tbody>";
    for (std::size_t r = 0; r < std::min(rows_shown, q.rows.size()); ++r) {
        const RankedRow& row = q.rows[r];
        html += "<tr><th scope=\"row\">" + escape_markup(row.name) + "</th><td>" + escape_markup(row.label) +
                "</td><td class=\"num\">" + (row.refined ? "" : "about ") + short_number(row.distance, 4) +
                "</td><td class=\"num\">" + short_number(row.error, 2) + "</td><td class=\"num\">" +
                share_text(row.hidden_share) + "</td></tr>";
    }
    html += "</tbody></table></div>";
    if (q.rows.size() > rows_shown) {
        html += "<p class=\"hint\">and " + std::to_string(q.rows.size() - rows_shown) + " more in ranking.csv</p>";
    }
    return html + "</div></section>\n";
}

}  // namespace

std::string reliability_figure(const std::vector<ReliabilityPoint>& points) {
    Svg svg(420, 320);
    const Scale x{0, 1, 60, 400}, y{0, 1, 270, 20};
    draw_axes(svg, x, y, "confidence that was stated", "share that was right");
    svg.line(x(0), y(0), x(1), y(1), "#9aa1ab", 1, "4 4");
    std::vector<std::pair<double, double>> line;
    for (const auto& p : points) {
        if (p.count == 0) continue;
        line.emplace_back(x(p.confidence), y(p.accuracy));
    }
    svg.polyline(line, "#2f5d9b", 2);
    for (const auto& p : points) {
        if (p.count == 0) continue;
        svg.circle(x(p.confidence), y(p.accuracy), 3 + std::min(6.0, std::sqrt(static_cast<double>(p.count))),
                   "#2f5d9b");
        svg.text(x(p.confidence) + 10, y(p.accuracy) + 10, std::to_string(p.count), 10);
    }
    return svg.document("Reliability of the confidences");
}

std::string render_classification(const ClassificationPage& page) {
    std::string html =
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
        "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; style-src "
        "'unsafe-inline'; base-uri 'none'; form-action 'none'\">\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<link rel=\"icon\" "
        "href=\"data:,\">\n"
        "<title>" +
        escape_markup(page.title) + " – classification</title>\n<style>\n" + std::string(assets::style) +
        std::string(own_style) + "</style>\n</head>\n<body>\n<header class=\"top\"><div class=\"title\">" +
        "<p class=\"kicker\">Classification by geodesics in shape space</p><h1>" + escape_markup(page.title) +
        "</h1><p class=\"headline\">" + escape_markup(page.headline) + "</p></div></header>\n<main id=\"main\">\n";
    html += "<section><ul class=\"tiles\">";
    for (const auto& [value, what] : page.tiles) {
        html += "<li><strong>" + escape_markup(value) + "</strong><span>" + escape_markup(what) + "</span></li>";
    }
    html += "</ul>";
    for (const auto& remark : page.remarks) html += "<p class=\"notice\">" + escape_markup(remark) + "</p>";
    html += "</section>\n";
    if (!page.hits_at_rank.empty()) {
        html += "<section id=\"hits\"><h2>Templates of the same class at rank 1, 2, ...</h2><table><thead><tr>";
        for (std::size_t r = 0; r < page.hits_at_rank.size(); ++r) {
            html += "<th class=\"num\">" + std::to_string(r + 1) + "</th>";
        }
        html += "</tr></thead><tbody><tr>";
        for (const double hits : page.hits_at_rank) html += "<td class=\"num\">" + short_number(hits, 4) + "</td>";
        html += "</tr></tbody></table></section>\n";
    }
    if (!page.confusion.empty()) html += confusion_table(page);
    if (!page.reliability.empty()) {
        html +=
            "<section id=\"reliability\"><h2>Reliability of the confidences</h2><img width=\"420\" height=\"320\" "
            "src=\"data:image/svg+xml;base64," +
            base64(reliability_figure(page.reliability)) +
            "\" alt=\"Stated confidence against the share of right answers\"></section>\n";
    }
    for (std::size_t i = 0; i < page.queries.size(); ++i) html += query_section(page.queries[i], i + 1);
    html += "<section id=\"settings\"><h2>Settings</h2><pre>" + escape_markup(page.command) +
            "</pre><dl class=\"numbers\">";
    for (const auto& [name, value] : page.settings) {
        html += "<div><dt>" + escape_markup(name) + "</dt><dd>" + escape_markup(value) + "</dd></div>";
    }
    return html + "</dl></section>\n</main>\n</body>\n</html>\n";
}

}  // namespace morphodesic::reports

#pragma once

#include <string>
#include <vector>

namespace morphodesic::datasets {

/// How files are read. One list of fields feeds command line, hash, store and report.
struct ImportOptions {
    std::string foreground = "auto";  ///< auto | dark | light | alpha: which pixels are the object
    double speck_fraction =
        0.002;                     ///< components and holes below this share of the shape's area are removed, in [0, 1)
    double max_megapixels = 64.0;  ///< images with more pixels are refused before memory is asked for, > 0
    std::string occluder;  ///< colour "#rrggbb" of what hides the object, or alpha: transparent is hidden; or empty
    std::string border = "free";   ///< free | hides: what is beyond a border that cuts the shape off counts as hidden
    double close_gaps = 0.6;       ///< widest hole of a surface that is closed, as a share of the object's size; from 1
                                   ///< on also scans of one side are closed, >= 0
    std::string noise = "smooth";  ///< smooth | keep: what is done with the noise of scanned surfaces
    std::string mirror;            ///< solids to be mirrored: file names or patterns with *, separated by commas
    std::string isovalue =
        "auto";                   ///< value at the surface of a volume, inside above; auto: 0 of a level set, else 0.5
    std::string inside = "auto";  ///< auto | above | below: which side of the isovalue of a volume is the object; auto:
                                  ///< above, refused where nearly all of the volume's border is
    double max_megabytes = 1000.0;  ///< larger meshes, point clouds and volumes are refused, > 0

    template <class Self, class Visitor>
    static void for_each_field(Self& self, Visitor&& visit) {
        visit("foreground", self.foreground, "pixels that are the object: auto, dark, light or alpha");
        visit("speck-fraction", self.speck_fraction, "specks and pinholes below this share of the shape are removed");
        visit("max-megapixels", self.max_megapixels, "refuse images with more than this many million pixels");
        visit("occluder", self.occluder, "colour #rrggbb of what hides the object, or alpha: transparent is hidden");
        visit("border", self.border,
              "hides: a shape that touches the border goes on unseen beyond it; free: it ends there");
        visit("close-gaps", self.close_gaps,
              "widest hole of a surface that is closed, as a share of the object's size");
        visit("noise", self.noise, "noise of scanned surfaces: smooth (only what is noise, not detail) or keep");
        visit("mirror", self.mirror, "solids to be mirrored: names or patterns with *, separated by commas");
        visit("isovalue", self.isovalue,
              "value at the surface of a volume; inside is above it (of a VDB level set below)");
        visit("inside", self.inside,
              "the object of a voxel volume: above the isovalue, below it, or auto (above, unless its border is)");
        visit("max-megabytes", self.max_megabytes, "refuse solids whose files are larger than this many megabytes");
    }
    /// Every violated constraint, in words; empty if the options are usable.
    [[nodiscard]] std::vector<std::string> problems() const;
    friend bool operator==(const ImportOptions&, const ImportOptions&) = default;
};

/// Part of what says whether a stored solid is that of its file. To be raised when a change of the readers or of the
/// repair changes solids, so that a study reads its files again and does not mix both.
inline constexpr int solid_reader_revision = 8;

}  // namespace morphodesic::datasets

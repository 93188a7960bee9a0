#pragma once

#include <string>
#include <vector>

namespace morphodesic::tests {

/// File names that a careless report would read as markup, script or structure. All are possible on Linux.
inline const std::vector<std::string> evil_names = {
    "<img src=x onerror=alert(1)>.png",
    "</script><script>alert(2)</script>.png",
    "<!--<script>.png",
    "\"quoted\" 'name' & more.png",
    "two\nlines\tand a tab.png",
    "-rf.png",
    "Blätter 葉 🍂.png",
    "not utf-8 \xFF\xC3.png",
    "{{DATA}}{{SCRIPT}}.png",
    "javascript:alert(3).png",
    "right to left \xE2\x80\xAEgnp.exe",
    "$(touch pwned) `id` $HOME.png",
};

}  // namespace morphodesic::tests

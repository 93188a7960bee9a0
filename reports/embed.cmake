# cmake -DOUTPUT=assets.cpp -DTEMPLATES=dir -DPARTS=scripts -DVEGA=dir -DWORK=dir -P embed.cmake
# Makes the one script of the report (Vega's modules and our page) and puts it, style and skeleton into a C++ file.
# The script's SHA-256 goes into the Content-Security-Policy, so that no other script can run in a report.
cmake_minimum_required(VERSION 3.25)

# Vega's modules in the order of their dependencies; the package has no bundle, but every module speaks CommonJS.
set(modules util time format loader canvas statistics scale scenegraph dataflow expression selection functions
  event-selector parser runtime interpreter view transforms view-transforms encode)
# A report is a copy of Vega, so it carries Vega's notice.
file(READ "${TEMPLATES}/notice.txt" notice)
set(script "\"use strict\";\n/*\n${notice}*/\nconst vegaModules = {};\n")
foreach(module IN LISTS modules)
  set(file "${VEGA}/vega-${module}.min.js")
  if(NOT EXISTS "${file}")
    message(FATAL_ERROR "${file} is missing: install the package libjs-vega")
  endif()
  file(READ "${file}" content)
  string(REGEX REPLACE "//# sourceMappingURL=[^\n]*" "" content "${content}")
  if(module STREQUAL "selection")
    set(module selections)  # the file's name differs from the module's
  endif()
  string(APPEND script "(function (module) { const exports = module.exports, require = name => vegaModules[name];\n"
    "${content}\nvegaModules[\"vega-${module}\"] = module.exports; })({exports: {}});\n")
endforeach()
foreach(part IN LISTS PARTS)
  file(READ "${TEMPLATES}/${part}" content)
  string(APPEND script "${content}")
endforeach()
string(REGEX MATCH "<(/[sS][cC][rR][iI][pP][tT]|!--)" forbidden "${script}")
if(forbidden)
  message(FATAL_ERROR "the script of the report contains ${forbidden}, which would end its element")
endif()
file(WRITE "${WORK}/report_script.js" "${script}")
file(SHA256 "${WORK}/report_script.js" hash)
file(READ "${TEMPLATES}/report.css" style)
file(READ "${TEMPLATES}/report.html" skeleton)

file(WRITE "${OUTPUT}.part" "// made by embed.cmake\n#include \"reports/assets.h\"\n\nnamespace morphodesic::reports::assets {\n")
foreach(asset IN ITEMS script style skeleton)
  file(APPEND "${OUTPUT}.part" "const std::string_view ${asset} = R\"MorphoAsset(${${asset}})MorphoAsset\";\n")
endforeach()
file(APPEND "${OUTPUT}.part" "const std::string_view script_sha256 = \"${hash}\";\n}\n")
file(RENAME "${OUTPUT}.part" "${OUTPUT}")

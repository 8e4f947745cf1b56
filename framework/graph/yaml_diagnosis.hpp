/// What is probably wrong with a text that is not YAML, in words and at the place where it is to be mended.
#pragma once

#include <string>

namespace pelorus::graph {

struct YamlDiagnosis {
    int line = 0, column = 0;  ///< from 1
    std::string text;          ///< "" if nothing was recognised
};

/// The parser stopped at `line` and `column` (from 1), which is often far behind the mistake. Recognised are tabs and
/// other blanks in the indentation, quotes and brackets that are open or closed by the wrong one, commas and blanks that are missing, a second
/// colon in a line, lines without a colon, indentation that fits no level, and characters that cannot begin a value.
YamlDiagnosis diagnose_yaml(const std::string& text, int line, int column);

/// What is to be said of a text that begins with a blank which YAML takes for a letter (a no-break space, and the like); "" if
/// it does not.
std::string blank_problem(const std::string& text);

}  // namespace pelorus::graph

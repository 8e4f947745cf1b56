/// Whether a printed line is what a test says it is, but for holes.
#pragma once

#include <string>

namespace pelorus::test {

/// `hole` stands for any text within a line; it is never empty.
inline bool line_matches(const std::string& expected, const std::string& printed, const std::string& hole) {
    const std::size_t gap = expected.find(hole);
    if (gap == std::string::npos) return expected == printed;
    if (printed.compare(0, gap, expected, 0, gap) != 0) return false;
    const std::string rest = expected.substr(gap + hole.size());
    for (std::size_t from = gap; from <= printed.size(); ++from)
        if (line_matches(rest, printed.substr(from), hole)) return true;
    return false;
}

}  // namespace pelorus::test

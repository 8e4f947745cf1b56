/// Work in a process of its own, so that it starts from a library that has done nothing yet, and leaves nothing behind.
#pragma once

#include <functional>
#include <string>

namespace pelorus::conformance {

struct Apart {
    std::string written;  ///< what the body answered
    std::string problem;  ///< why it did not come to its end, or ""
};

/// Runs the body in a fork of this process, which then ends without further ado.
Apart apart(const std::function<std::string()>& body);

}  // namespace pelorus::conformance

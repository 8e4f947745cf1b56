/// A browser without a window, which draws the plots of a page.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace pelorus::report {

/// Chromium (or Chrome) on the PATH; "" where there is none.
std::filesystem::path find_browser();

/// The plots of a page, written as `FOLDER/NAME.FORMAT`; answers their names. `format` is png or svg. Throws Error (Exit::run_failed): there
/// is no browser, it ends badly or in two minutes not at all, a file cannot be written.
std::vector<std::string> write_plots(const std::filesystem::path& page, const std::filesystem::path& folder,
                                     const std::string& format);

}  // namespace pelorus::report

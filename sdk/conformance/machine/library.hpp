/// The library under test, in the process that tries it.
#pragma once

#include <cstdint>
#include <string>

#include <pelorus/abi/abi.h>

namespace pelorus::conformance {

class Library {
public:
    /// Loads the library (RTLD_NOW | RTLD_LOCAL) and starts it, once a process. Fails the check with the loader's own words.
    static const Library& load(const std::string& path);

    const std::string& path() const noexcept { return path_; }
    const plr_entry_point& entry() const noexcept { return *entry_; }
    /// Fails the check if the factory does not know it.
    const plr_plugin& plugin(const std::string& id) const;

private:
    explicit Library(const std::string& path);
    std::string path_;
    const plr_entry_point* entry_ = nullptr;
};

/// An error struct as callers hand it in.
plr_error empty_error() noexcept;
/// What a plugin told: `where: message (item 3)`, or the name of the status.
std::string told(plr_status status, const plr_error& error);
const char* status_name(plr_status status) noexcept;
/// What the exception says that is being handled: one that has left a plugin.
std::string exception_text();

}  // namespace pelorus::conformance

/// How closely the host watches the models that plugins call.
#pragma once

#include <string>

namespace pelorus::host {

enum class GuardMode {
    off,    ///< holders get the plugins' own tables; nothing is in between
    start,  ///< the first calls of each function of each instance are checked, after that only exceptions are caught
    all     ///< every call is checked
};

/// `off`, `start`, `all`. Throws Error (Exit::misuse) for another word.
GuardMode guard_mode(const std::string& word);

}  // namespace pelorus::host

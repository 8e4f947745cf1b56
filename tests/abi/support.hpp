/// What the tests of the ABI share: abi.py, sets of headers, and programs compiled against them.
#pragma once

#include <string>
#include <vector>

#include "../fixtures/temporary_folder.hpp"
#include "../support/process.hpp"

namespace pelorus::test {

/// Folders that hold `pelorus/abi/*.h`.
inline const std::string today = PELORUS_SOURCE_DIR "/sdk/include";
inline const std::string older = PELORUS_SOURCE_DIR "/tests/abi/headers-1.1";

/// tests/abi/abi.py COMMAND for a folder of headers and one of records.
Ended abi(const std::string& command, const std::string& headers, const std::string& baseline,
          const std::string& compiler = "cc");

/// A set of headers in which every struct that may grow has a member more at its end, and PLR_ABI_MINOR is one more: what a
/// later release may look like.
std::string write_newer_headers(const TemporaryFolder& folder);

/// Compiles C11 without a warning against a set of headers alone.
void compile(const std::string& headers, const std::string& source, const std::string& out,
             const std::vector<std::string>& flags);
/// Likewise, a plugin.
void compile_plugin(const std::string& headers, const std::string& source, const std::string& out);

/// `from` in the file becomes `to`; fails where it does not stand exactly once.
void replace_in(const std::string& file, const std::string& from, const std::string& to);

}  // namespace pelorus::test

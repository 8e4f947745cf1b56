/// What may stand at a place of the command line, for the shell to complete.
#pragma once

#include <string>
#include <vector>

namespace pelorus::cli {

/// `words` are the line's words, `pelorus` the first, as bash splits them (`--out=DIR` are three); `at` is the one under the cursor.
/// Answers words that begin as it does, and what the shell has to look up itself: `:folders`, `:files`, `:files .yaml`. Throws
/// nothing: where nothing can be said, there are no candidates.
std::vector<std::string> candidates(const std::vector<std::string>& words, std::size_t at) noexcept;

}  // namespace pelorus::cli

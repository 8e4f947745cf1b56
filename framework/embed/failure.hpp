/// What went wrong with a call of the embedding API, with the status that it answers.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

#include <pelorus/abi/status.h>

namespace pelorus::embed {

class Failure : public std::runtime_error {
public:
    Failure(plr_status code, const std::string& text, std::int64_t item = -1)
        : std::runtime_error(text), code_(code), item_(item) {}
    plr_status code() const noexcept { return code_; }
    std::int64_t item() const noexcept { return item_; }

private:
    plr_status code_;
    std::int64_t item_;
};

}  // namespace pelorus::embed

/// What a campaign keeps on disk while it goes on, so that a kill at any moment loses nothing that was finished.
///
///     DIR/campaign.json       what is computed: another campaign's cells and blocks must not get into this one
///     DIR/cells/000017.json   a finished cell; written beside, then renamed
///     DIR/cells/000017.blocks blocks of runs of a cell that is not finished; appended to, each behind its size and its checksum
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "campaign/totals.hpp"

namespace pelorus::campaign {

class Store {
public:
    explicit Store(std::filesystem::path folder) : folder_(std::move(folder)) {}
    ~Store();
    Store(const Store&) = delete;
    Store& operator=(const Store&) = delete;

    /// What campaign.json says; nothing where there is none. Throws Error: it cannot be read.
    std::optional<nlohmann::ordered_json> identity() const;

    /// Keeps others out of the folder for as long as this lives. Throws Error: somebody else is at work there.
    void lock();
    /// Throws away what an earlier campaign has left, and begins this one. Throws Error.
    void begin(const nlohmann::ordered_json& identity);

    /// Whether it is finished.
    bool has_cell(std::size_t cell) const;
    /// Whether anything of it is kept.
    bool is_begun(std::size_t cell) const;
    /// Throws Error: it cannot be read.
    nlohmann::ordered_json cell(std::size_t cell) const;
    /// The blocks of an unfinished cell. One that was being written when the process ended is cut off.
    std::vector<std::pair<std::uint64_t, Totals>> blocks(std::size_t cell) const;

    /// Throws Error: the disk is full, and so on.
    void append(std::size_t cell, std::uint64_t block, const Totals& totals) const;
    /// The cell's blocks are not needed any more. Throws Error.
    void finish(std::size_t cell, const nlohmann::ordered_json& finished) const;

private:
    std::filesystem::path file(std::size_t cell, const char* ending) const;

    std::filesystem::path folder_;
    int lock_ = -1;
};

/// `DIR/campaign.json`
std::filesystem::path campaign_file(const std::filesystem::path& folder);

}  // namespace pelorus::campaign

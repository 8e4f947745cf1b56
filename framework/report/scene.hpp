/// Where things were: the tables of tracks, truth and scans in a result folder, made small enough for a page.
#pragma once

#include <filesystem>

#include <nlohmann/json.hpp>

namespace pelorus::report {

/// Each table that tells Cartesian positions (columns `position.x`, `position.y` and perhaps `position.z`), known by its columns, whatever
/// its name: tracks have a `status`, truth has a `parent`, scans have an `snr`.
///
///     [{name, kind, times, every, time: [..], id: [..], position: [[x..], [y..], [z..]], extent: [[xx..], [xy..], ..], lineage}]
///
/// A table of tracks to whose ids the column `group` of another one leads is of kind `groups`. `lineage` is that of lineage.hpp, or null.
/// `extent` is null where there is none. Of a table with more than 20 000 entries every k-th time is kept, the smallest k with which that
/// many remain; `times` is how many there are and `every` is k. Throws Error (Exit::run_failed) for a row that is damaged, `FILE:LINE`.
nlohmann::ordered_json read_scene(const std::filesystem::path& folder);

}  // namespace pelorus::report

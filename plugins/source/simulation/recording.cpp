#include "recording.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <string>

#include <pelorus/failure.hpp>

namespace simulation {

namespace {

constexpr const char* ending = "_meas.csv";
constexpr std::uint64_t most_ticks = 10'000'000;

[[noreturn]] void refuse(const std::string& problem) { throw pelorus::ParameterError("recording", problem); }

/// NAME_truth.csv beside NAME_meas.csv.
std::filesystem::path truth_beside(const std::filesystem::path& measured) {
    std::string name = measured.filename().string();
    const std::string end = ending;
    if (name.size() < end.size() || name.compare(name.size() - end.size(), end.size(), end) != 0)
        refuse(measured.string() + " is not named NAME" + end + ", with the truth in NAME_truth.csv beside it");
    name.replace(name.size() - end.size(), end.size(), "_truth.csv");
    return measured.parent_path() / name;
}

/// FNV-1a, 64 bits.
std::uint64_t digested(std::uint64_t digest, char next) noexcept {
    return (digest ^ static_cast<unsigned char>(next)) * 1099511628211u;
}

struct Row {
    std::uint64_t tick = 0, object = 0;
    double position[3] = {0, 0, 0};  // m
};

/// Reads a number and the comma after it, or the end of the line where it is the last.
template <class Number> bool take(const char*& at, const char* end, Number& number, bool last) {
    const auto [rest, problem] = std::from_chars(at, end, number);
    if (problem != std::errc() || (last ? rest != end : rest == end || *rest != ',')) return false;
    at = last ? rest : rest + 1;
    return true;
}

bool parse(const std::string& line, Row& row) {
    const char *at = line.data(), *const end = at + line.size();
    if (!take(at, end, row.tick, false) || !take(at, end, row.object, false)) return false;
    for (int axis = 0; axis < 3; ++axis)
        if (!take(at, end, row.position[axis], axis == 2) || !std::isfinite(row.position[axis])) return false;
    return true;
}

}  // namespace

Recording::Recording(const std::filesystem::path& measured, std::uint64_t objects) : objects_(objects) {
    const std::filesystem::path truth = truth_beside(measured);
    measured_ = read(measured);
    truth_ = read(truth);
    ticks_ = std::max(measured_.size(), truth_.size()) / (3 * objects_);
}

Recording::Table Recording::read(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    if (!in) refuse("cannot read " + file.string());
    Table table;
    std::string line;
    for (std::uint64_t number = 1; std::getline(in, line); ++number) {
        for (const char c : line) digest_ = digested(digest_, c);
        digest_ = digested(digest_, '\n');
        if (!line.empty() && line.back() == '\r') line.pop_back();
        if (line.empty()) continue;
        const std::string where = file.string() + ", line " + std::to_string(number) + ": ";
        Row row;
        if (!parse(line, row)) refuse(where + "expected k,i,x,y,z, five numbers");
        if (row.object >= objects_)
            refuse(where + "tells of object " + std::to_string(row.object) + "; those of the targets are 0 to " +
                   std::to_string(objects_ - 1));
        if (row.tick >= most_ticks) refuse(where + "tick " + std::to_string(row.tick) + " is beyond all use");
        if (table.size() < (row.tick + 1) * objects_ * 3)
            table.resize((row.tick + 1) * objects_ * 3, std::numeric_limits<double>::quiet_NaN());
        double* const to = table.data() + (row.tick * objects_ + row.object) * 3;
        if (!std::isnan(*to))
            refuse(where + "object " + std::to_string(row.object) + " at tick " + std::to_string(row.tick) +
                   " was told before");
        for (int axis = 0; axis < 3; ++axis) to[axis] = row.position[axis];
    }
    if (in.bad()) refuse("cannot read " + file.string());
    return table;
}

const double* Recording::at(const Table& table, std::uint64_t tick, std::uint64_t object) const noexcept {
    const std::uint64_t place = (tick * objects_ + object) * 3;
    return place < table.size() && !std::isnan(table[place]) ? table.data() + place : nullptr;
}

}  // namespace simulation

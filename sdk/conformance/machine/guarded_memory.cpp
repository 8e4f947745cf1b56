#include "guarded_memory.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstring>
#include <map>
#include <mutex>
#include <new>
#include <vector>

namespace pelorus::conformance {

namespace {

constexpr std::uint64_t pattern_bits = 0x7FF8'C0DE'FACE'B00Cu;
constexpr std::size_t longest_name = 64;

/// Kept in static memory, because the signal handler reads it.
struct Zone {
    std::atomic<bool> is_taken{false};
    std::atomic<const unsigned char*> mapping{nullptr};  // nullptr: not yet, or no longer, described
    std::size_t mapped = 0;
    const unsigned char* first = nullptr;  // of the array
    const unsigned char* end = nullptr;
    bool is_taken_back = false;
    char function[longest_name] = {}, array[longest_name] = {};
};
std::array<Zone, 4096> zones;

std::size_t page() noexcept {
    static const auto size = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    return size;
}

void copy_name(char (&to)[longest_name], const std::string& from) noexcept {
    const std::size_t length = std::min(from.size(), longest_name - 1);
    std::memcpy(to, from.data(), length);
    to[length] = 0;
}

int add_zone(const unsigned char* mapping, std::size_t mapped, const double* data, std::size_t doubles,
             const ZoneName& name) noexcept {
    for (std::size_t i = 0; i < zones.size(); ++i) {
        Zone& zone = zones[i];
        if (zone.is_taken.exchange(true)) continue;
        zone.mapped = mapped;
        zone.first = reinterpret_cast<const unsigned char*>(data);
        zone.end = reinterpret_cast<const unsigned char*>(data + doubles);
        zone.is_taken_back = false;
        copy_name(zone.function, name.function);
        copy_name(zone.array, name.array);
        zone.mapping = mapping;
        return static_cast<int>(i);
    }
    return -1;  // its pages still guard it; only the report is poorer
}

}  // namespace

namespace {

/// Mappings that are used again, because the system takes its time over making and ending them. By size; ready to be written.
std::mutex kept_mutex;
std::map<std::size_t, std::vector<unsigned char*>> kept;
constexpr std::size_t most_kept_of_a_size = 64, largest_kept = std::size_t{1} << 20;

unsigned char* new_mapping(std::size_t mapped) {
    void* const memory = mmap(nullptr, mapped, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) throw std::bad_alloc();
    auto* const mapping = static_cast<unsigned char*>(memory);
    if (mprotect(mapping + page(), mapped - 2 * page(), PROT_READ | PROT_WRITE) != 0) throw std::bad_alloc();
    return mapping;
}

unsigned char* take_mapping(std::size_t mapped) {
    {
        const std::lock_guard<std::mutex> lock(kept_mutex);
        std::vector<unsigned char*>& same = kept[mapped];
        if (!same.empty()) {
            unsigned char* const mapping = same.back();
            same.pop_back();
            return mapping;
        }
    }
    return new_mapping(mapped);
}

void give_back(unsigned char* mapping, std::size_t mapped, bool is_read_only) {
    if (mapped <= largest_kept &&
        (!is_read_only || mprotect(mapping + page(), mapped - 2 * page(), PROT_READ | PROT_WRITE) == 0)) {
        const std::lock_guard<std::mutex> lock(kept_mutex);
        std::vector<unsigned char*>& same = kept[mapped];
        if (same.size() < most_kept_of_a_size) {
            same.push_back(mapping);
            return;
        }
    }
    munmap(mapping, mapped);
}

}  // namespace

GuardedMemory::GuardedMemory(std::size_t doubles, const ZoneName& name) : doubles_(doubles) {
    const std::size_t bytes = doubles * sizeof(double);
    const std::size_t inner = (bytes + page() - 1) / page() * page() + (bytes == 0 ? page() : 0);
    mapped_ = inner + 2 * page();
    mapping_ = take_mapping(mapped_);
    for (std::size_t at = 0; at < inner; at += sizeof pattern_bits)
        std::memcpy(mapping_ + page() + at, &pattern_bits, sizeof pattern_bits);
    data_ = reinterpret_cast<double*>(mapping_ + page() + inner - bytes);
    zone_ = add_zone(mapping_, mapped_, data_, doubles_, name);
}

GuardedMemory::GuardedMemory(GuardedMemory&& other) noexcept
    : mapping_(other.mapping_),
      mapped_(other.mapped_),
      doubles_(other.doubles_),
      data_(other.data_),
      zone_(other.zone_),
      is_read_only_(other.is_read_only_) {
    other.mapping_ = nullptr;
    other.zone_ = -1;
}

GuardedMemory::~GuardedMemory() {
    if (zone_ >= 0) {
        Zone& zone = zones[static_cast<std::size_t>(zone_)];
        zone.mapping = nullptr;
        zone.is_taken = false;
    }
    if (mapping_ != nullptr) give_back(mapping_, mapped_, is_read_only_);
}

void GuardedMemory::make_read_only() {
    mprotect(mapping_ + page(), mapped_ - 2 * page(), PROT_READ);
    is_read_only_ = true;
}

void GuardedMemory::take_back() {
    mprotect(mapping_, mapped_, PROT_NONE);
    is_read_only_ = true;  // for giving it back
    if (zone_ >= 0) zones[static_cast<std::size_t>(zone_)].is_taken_back = true;
}

bool GuardedMemory::is_intact_before() const noexcept {
    const unsigned char* const end = reinterpret_cast<const unsigned char*>(data_);
    for (const unsigned char* at = mapping_ + page(); at < end; at += sizeof pattern_bits)
        if (std::memcmp(at, &pattern_bits, sizeof pattern_bits) != 0) return false;
    return true;
}

double GuardedMemory::pattern() noexcept {
    double value;
    std::memcpy(&value, &pattern_bits, sizeof value);
    return value;
}

bool GuardedMemory::is_pattern(double value) noexcept { return std::memcmp(&value, &pattern_bits, sizeof value) == 0; }

bool find_zone(const void* address, ZoneHit& hit) noexcept {
    const auto* const at = static_cast<const unsigned char*>(address);
    for (const Zone& zone : zones) {
        const unsigned char* const mapping = zone.mapping;
        if (mapping == nullptr || at < mapping || at >= mapping + zone.mapped) continue;
        hit.function = zone.function;
        hit.array = zone.array;
        hit.is_read_only = at >= zone.first && at < zone.end;
        hit.is_taken_back = zone.is_taken_back;
        hit.bytes = at >= zone.end ? at - zone.end : at < zone.first ? at - zone.first : 0;
        return true;
    }
    return false;
}

}  // namespace pelorus::conformance

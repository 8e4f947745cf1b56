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

constexpr std::size_t most_kept_of_a_size = 64, largest_kept = std::size_t{1} << 20;

/// Mappings that are used again, because the system takes its time over making and ending them. By size; ready to be written.
class KeptMappings {
public:
    explicit KeptMappings(Lent lent) : lent_(lent) {}

    GuardedMapping take(std::size_t size) {
        const std::lock_guard<std::mutex> lock(mutex_);
        std::vector<GuardedMapping>& same = of_this_process()[size];
        if (same.empty()) return made(size);
        const GuardedMapping mapping = same.back();
        same.pop_back();
        return mapping;
    }

    void give_back(const GuardedMapping& mapping, bool is_as_made) {
        if (mapping.size <= largest_kept && is_as_made) {
            const std::lock_guard<std::mutex> lock(mutex_);
            std::vector<GuardedMapping>& same = of_this_process()[mapping.size];
            if (same.size() < most_kept_of_a_size) {
                same.push_back(mapping);
                return;
            }
        }
        munmap(mapping.begin, mapping.size);
        if (lent_ == Lent::for_reading) munmap(mapping.owner, mapping.size - 2 * page());
    }

private:
    /// What another process kept, from which this one was forked, would be shared with it.
    std::map<std::size_t, std::vector<GuardedMapping>>& of_this_process() {
        if (lent_ == Lent::for_reading && process_ != getpid()) {
            kept_.clear();
            process_ = getpid();
        }
        return kept_;
    }

    GuardedMapping made(std::size_t size) const {
        const std::size_t inner = size - 2 * page();
        void* const begin = mmap(nullptr, size, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        if (begin == MAP_FAILED) throw std::bad_alloc();
        auto* const memory = static_cast<unsigned char*>(begin) + page();
        if (lent_ == Lent::for_reading) return {static_cast<unsigned char*>(begin), view_twice(memory, inner), size};
        if (mprotect(memory, inner, PROT_READ | PROT_WRITE) != 0) throw std::bad_alloc();
        return {static_cast<unsigned char*>(begin), memory, size};
    }

    /// Puts memory there that can only be read, and answers where it can be written: so no call needs a change of protection.
    static unsigned char* view_twice(unsigned char* there, std::size_t inner) {
        const int file = memfd_create("pelorus-conform", MFD_CLOEXEC);
        if (file < 0) throw std::bad_alloc();
        void* owner = MAP_FAILED;
        if (ftruncate(file, static_cast<off_t>(inner)) == 0 &&
            mmap(there, inner, PROT_READ, MAP_SHARED | MAP_FIXED, file, 0) != MAP_FAILED)
            owner = mmap(nullptr, inner, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
        close(file);
        if (owner == MAP_FAILED) throw std::bad_alloc();
        return static_cast<unsigned char*>(owner);
    }

    Lent lent_;
    pid_t process_ = 0;
    std::mutex mutex_;
    std::map<std::size_t, std::vector<GuardedMapping>> kept_;
};

KeptMappings& kept_mappings(Lent lent) {
    static KeptMappings written(Lent::for_writing), read(Lent::for_reading);
    return lent == Lent::for_reading ? read : written;
}

}  // namespace

GuardedMemory::GuardedMemory(std::size_t doubles, const ZoneName& name, Lent lent) : lent_(lent), doubles_(doubles) {
    const std::size_t bytes = doubles * sizeof(double);
    const std::size_t inner = (bytes + page() - 1) / page() * page() + (bytes == 0 ? page() : 0);
    mapping_ = kept_mappings(lent).take(inner + 2 * page());
    for (std::size_t at = 0; at < inner; at += sizeof pattern_bits)
        std::memcpy(mapping_.owner + at, &pattern_bits, sizeof pattern_bits);
    data_ = reinterpret_cast<double*>(mapping_.begin + page() + inner - bytes);
    fill_ = reinterpret_cast<double*>(mapping_.owner + inner - bytes);
    zone_ = add_zone(mapping_.begin, mapping_.size, data_, doubles_, name);
}

GuardedMemory::GuardedMemory(GuardedMemory&& other) noexcept
    : lent_(other.lent_),
      mapping_(other.mapping_),
      doubles_(other.doubles_),
      data_(other.data_),
      fill_(other.fill_),
      zone_(other.zone_),
      is_read_only_(other.is_read_only_) {
    other.mapping_.begin = nullptr;
    other.zone_ = -1;
}

GuardedMemory::~GuardedMemory() {
    if (zone_ >= 0) {
        Zone& zone = zones[static_cast<std::size_t>(zone_)];
        zone.mapping = nullptr;
        zone.is_taken = false;
    }
    if (mapping_.begin == nullptr) return;
    const std::size_t inner = mapping_.size - 2 * page();
    const bool is_as_made = !is_read_only_ || (lent_ == Lent::for_writing &&
                                               mprotect(mapping_.begin + page(), inner, PROT_READ | PROT_WRITE) == 0);
    kept_mappings(lent_).give_back(mapping_, is_as_made);
}

void GuardedMemory::make_read_only() {
    mprotect(mapping_.begin + page(), mapping_.size - 2 * page(), PROT_READ);
    is_read_only_ = true;
}

void GuardedMemory::take_back() {
    mprotect(mapping_.begin, mapping_.size, PROT_NONE);
    is_read_only_ = true;  // for giving it back
    if (zone_ >= 0) zones[static_cast<std::size_t>(zone_)].is_taken_back = true;
}

bool GuardedMemory::is_intact_before() const noexcept {
    const unsigned char* const end = reinterpret_cast<const unsigned char*>(data_);
    for (const unsigned char* at = mapping_.begin + page(); at < end; at += sizeof pattern_bits)
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

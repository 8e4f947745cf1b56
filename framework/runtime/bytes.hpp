/// Numbers, texts and blocks to bytes and back, in the machine's own byte order (little-endian wherever Pelorus runs).
#pragma once

#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace pelorus::runtime {

class ByteWriter {
public:
    template <class Number> void number(Number x) {
        static_assert(std::is_arithmetic_v<Number>);
        block(&x, sizeof x);
    }
    void block(const void* from, std::size_t size) {
        const auto* first = static_cast<const unsigned char*>(from);
        if (size) bytes_.insert(bytes_.end(), first, first + size);
    }
    /// A block behind its size.
    void sized(const void* from, std::size_t size) {
        number(std::uint64_t{size});
        block(from, size);
    }
    void text(const std::string& x) { sized(x.data(), x.size()); }

    std::vector<unsigned char>& bytes() noexcept { return bytes_; }

private:
    std::vector<unsigned char> bytes_;
};

/// The bytes are not what a writer wrote.
struct CorruptBytes : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Reads what ByteWriter wrote. Never reads beyond the end, never allocates more than there are bytes left; throws
/// CorruptBytes.
class ByteReader {
public:
    ByteReader(const unsigned char* first, std::size_t size) : at_(first), left_(size) {}

    template <class Number> Number number() {
        static_assert(std::is_arithmetic_v<Number> && !std::is_same_v<Number, bool>);
        Number x;
        block(&x, sizeof x);
        return x;
    }
    void block(void* to, std::size_t size) {
        const unsigned char* from = take(size);
        if (size) std::memcpy(to, from, size);
    }
    bool flag() {
        const auto x = number<std::uint8_t>();
        if (x > 1) throw CorruptBytes("a flag is neither 0 nor 1");
        return x == 1;
    }
    /// A number of entries of at least `entry_size` bytes each, all of which must still come.
    std::size_t count(std::size_t entry_size) {
        const auto n = number<std::uint64_t>();
        if (n > left_ / entry_size) throw CorruptBytes("it ends within a list");
        return static_cast<std::size_t>(n);
    }
    std::vector<unsigned char> sized() {
        const std::size_t size = count(1);
        const unsigned char* from = take(size);
        return {from, from + size};
    }
    std::string text() {
        const std::size_t size = count(1);
        const unsigned char* from = take(size);
        return {reinterpret_cast<const char*>(from), size};
    }
    std::size_t left() const noexcept { return left_; }

private:
    const unsigned char* take(std::size_t size) {
        if (size > left_) throw CorruptBytes("it ends early");
        const unsigned char* from = at_;
        at_ += size;
        left_ -= size;
        return from;
    }
    const unsigned char* at_;
    std::size_t left_;
};

}  // namespace pelorus::runtime

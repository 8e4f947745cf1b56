/// Saved state: one function that names the members serves both ways.
///
///     template <class Archive> void state(Archive& archive) { archive(tracks_, next_id_, last_time_); }
///
/// Understands arithmetic types, enums, std::string, std::vector, std::deque, std::map, std::set, std::optional, std::pair, std::array, Eigen
/// matrices, and structs that have such a `state` of their own. Little-endian bytes, no padding.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <pelorus/failure.hpp>

namespace pelorus {

namespace detail {
template <class T> struct is_resizable_list : std::false_type {};
template <class T> struct is_resizable_list<std::vector<T>> : std::bool_constant<!std::is_same_v<T, bool>> {};
template <class T> struct is_resizable_list<std::deque<T>> : std::true_type {};
template <class T> constexpr bool is_eigen = std::is_base_of_v<Eigen::PlainObjectBase<T>, T>;
}  // namespace detail

class StateWriter {
public:
    static constexpr bool reading = false;
    template <class... Values> void operator()(Values&... values) { (put(values), ...); }
    const std::vector<unsigned char>& bytes() const noexcept { return bytes_; }

private:
    void raw(const void* from, std::size_t size) {
        const auto* p = static_cast<const unsigned char*>(from);
        bytes_.insert(bytes_.end(), p, p + size);
    }
    void put(const std::string& text) {
        size(text.size());
        raw(text.data(), text.size());
    }
    void put(std::string& text) { put(static_cast<const std::string&>(text)); }
    void size(std::size_t n) {
        const auto wide = static_cast<std::uint64_t>(n);
        raw(&wide, sizeof wide);
    }
    template <class K, class V> void put(std::map<K, V>& map) {
        size(map.size());
        for (auto& [key, value] : map) {
            K copy = key;
            put(copy);
            put(value);
        }
    }
    template <class K> void put(std::set<K>& set) {
        size(set.size());
        for (const auto& key : set) {
            K copy = key;
            put(copy);
        }
    }
    template <class A, class B> void put(std::pair<A, B>& pair) {
        put(pair.first);
        put(pair.second);
    }
    template <class T, std::size_t N> void put(std::array<T, N>& array) {
        for (auto& value : array) put(value);
    }
    template <class T> void put(std::optional<T>& value) {
        unsigned char present = value.has_value();
        raw(&present, 1);
        if (value) put(*value);
    }
    template <class T> void put(T& value) {
        if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
            raw(&value, sizeof value);
        } else if constexpr (detail::is_resizable_list<T>::value) {
            size(value.size());
            for (auto& element : value) put(element);
        } else if constexpr (detail::is_eigen<T>) {
            size(static_cast<std::size_t>(value.rows()));
            size(static_cast<std::size_t>(value.cols()));
            raw(value.data(), static_cast<std::size_t>(value.size()) * sizeof(typename T::Scalar));
        } else {
            value.state(*this);
        }
    }
    std::vector<unsigned char> bytes_;
};

/// Throws DataError where bytes are missing or make no sense.
class StateReader {
public:
    static constexpr bool reading = true;
    StateReader(const void* bytes, std::size_t size) : at_(static_cast<const unsigned char*>(bytes)), left_(size) {}
    template <class... Values> void operator()(Values&... values) { (get(values), ...); }
    std::size_t left() const noexcept { return left_; }

private:
    void raw(void* to, std::size_t size) {
        if (size > left_) throw DataError("saved state is truncated");
        if (size != 0) std::memcpy(to, at_, size);
        at_ += size;
        left_ -= size;
    }
    /// A count of elements, each of which takes a byte at least: so no count can ask for more memory than bytes came.
    std::size_t size() {
        std::uint64_t wide = 0;
        raw(&wide, sizeof wide);
        if (wide > left_) throw DataError("saved state is truncated or corrupt");
        return static_cast<std::size_t>(wide);
    }
    void get(std::string& text) {
        text.resize(size());
        raw(text.data(), text.size());
    }
    template <class K, class V> void get(std::map<K, V>& map) {
        map.clear();
        for (std::size_t n = size(); n > 0; --n) {
            K key{};
            get(key);
            get(map[key]);
        }
    }
    template <class K> void get(std::set<K>& set) {
        set.clear();
        for (std::size_t n = size(); n > 0; --n) {
            K key{};
            get(key);
            set.insert(std::move(key));
        }
    }
    template <class A, class B> void get(std::pair<A, B>& pair) {
        get(pair.first);
        get(pair.second);
    }
    template <class T, std::size_t N> void get(std::array<T, N>& array) {
        for (auto& value : array) get(value);
    }
    template <class T> void get(std::optional<T>& value) {
        unsigned char present = 0;
        raw(&present, 1);
        if (present > 1) throw DataError("saved state is corrupt");
        value.reset();
        if (present == 1) get(value.emplace());
    }
    template <class T> void get(T& value) {
        if constexpr (std::is_same_v<T, bool>) {
            unsigned char byte = 0;
            raw(&byte, 1);
            if (byte > 1) throw DataError("saved state is corrupt");
            value = byte == 1;
        } else if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
            raw(&value, sizeof value);
        } else if constexpr (detail::is_resizable_list<T>::value) {
            value.clear();
            for (std::size_t n = size(); n > 0; --n) get(value.emplace_back());  // memory grows only as bytes come
        } else if constexpr (detail::is_eigen<T>) {
            const std::size_t rows = size(), cols = size();
            const bool fits =
                (T::RowsAtCompileTime == Eigen::Dynamic || T::RowsAtCompileTime == static_cast<int>(rows)) &&
                (T::ColsAtCompileTime == Eigen::Dynamic || T::ColsAtCompileTime == static_cast<int>(cols)) &&
                (cols == 0 || rows <= left_ / cols / sizeof(typename T::Scalar));
            if (!fits) throw DataError("saved state is of other dimensions");
            value.resize(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(cols));
            raw(value.data(), rows * cols * sizeof(typename T::Scalar));
        } else {
            value.state(*this);
        }
    }
    const unsigned char* at_;
    std::size_t left_;
};

}  // namespace pelorus

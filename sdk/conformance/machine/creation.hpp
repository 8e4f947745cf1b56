/// create, called directly on what a living instance was made from, so that nothing of the suites' own is in between; and values
/// for it that no config would give.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "instance.hpp"

namespace pelorus::conformance {

/// One call of create. What it made is destroyed with this.
class Creation {
public:
    Creation(const plr_plugin& plugin, const plr_config& config);
    /// With an error struct of the caller's.
    Creation(const plr_plugin& plugin, const plr_config& config, plr_error& error);
    /// Whose n-th allocation fails (0: the first).
    static Creation with_failing_allocation(const plr_plugin& plugin, const plr_config& config, std::int64_t n);
    ~Creation();
    Creation(Creation&& other) noexcept;
    Creation& operator=(Creation&&) = delete;

    bool is_made() const noexcept { return left_by_.empty() && status_ == PLR_OK && instance_.table != nullptr; }
    plr_status status() const noexcept { return status_; }
    const plr_error& error() const noexcept { return error_; }
    const plr_instance& instance() const noexcept { return instance_; }
    /// What an exception said that left create; "" if none did.
    const std::string& left_by() const noexcept { return left_by_; }
    /// Whether the allocation that was to fail was asked for.
    bool has_failed_allocation() const noexcept { return has_failed_allocation_; }
    std::string told() const;

private:
    Creation() = default;
    void call(const plr_plugin& plugin, const plr_config& config, plr_error& error, std::int64_t failing);

    plr_status status_ = PLR_OK;
    plr_error error_{};
    plr_instance instance_{};
    std::string left_by_;
    bool has_failed_allocation_ = false;
};

/// The config of an instance, with other values.
class AlteredConfig {
public:
    explicit AlteredConfig(const Instance& instance);
    AlteredConfig(const AlteredConfig&) = delete;
    AlteredConfig& operator=(const AlteredConfig&) = delete;

    const plr_config& get() const noexcept { return config_; }
    /// Sets a number, or every element of a vector or matrix; an optional one is given with it. False if it has no numbers.
    bool set(std::uint32_t parameter, double number);
    bool set_integer(std::uint32_t parameter, std::int64_t integer);
    /// Sets the text of a string or path.
    bool set_text(std::uint32_t parameter, std::string text);
    /// Makes a table have so many rows, the given ones over and over. False if it has none.
    bool set_rows(std::uint32_t parameter, std::int64_t rows);
    /// Sets the number of a column in all rows of a table. False if it has no rows.
    bool set_column(std::uint32_t parameter, std::uint32_t column, double number);

private:
    plr_config config_;
    std::vector<plr_value> values_;
    // By parameter, where they are our own.
    std::vector<std::vector<double>> numbers_;
    std::vector<std::string> text_;
    std::vector<std::vector<const char*>> texts_;
    const plr_description& description_;
};

/// A value to be handed to one parameter.
struct Trial {
    std::uint32_t parameter;
    std::string title;  ///< `noise: 0`
    double number;  ///< of an int or bool parameter: a whole one; of a table: that of `column`, or the number of rows
    std::string text{};        ///< of a string or path
    std::int64_t column = -1;  ///< of a table, or -1
};
/// Values at and just inside the bounds of each parameter and column of numbers; every choice; both booleans; strings and paths
/// that are empty, long, or of unusual characters; tables of as few and of more rows.
std::vector<Trial> trials_within(const plr_description& description);
/// Not a number, infinite, and beyond the bounds.
std::vector<Trial> trials_outside(const plr_description& description);
/// False where the parameter has no value that could be altered.
bool apply(const Trial& trial, const plr_description& description, AlteredConfig& config);

/// Element `index` of an array of a description.
template <class Element> const Element& element_of(const Element* first, std::uint32_t index) noexcept {
    const auto* at = reinterpret_cast<const unsigned char*>(first);
    return *reinterpret_cast<const Element*>(at + std::uint64_t{index} * first->struct_size);
}

}  // namespace pelorus::conformance

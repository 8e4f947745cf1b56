// Plugins without a host: loads a plugin of the build folder, makes instances from parameters as one would write them, and
// holds the context of a call. For tests of plugins and of models that stand in others' slots.
#pragma once

#include <dlfcn.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <pelorus/abi/abi.h>
#include <pelorus/matrix.hpp>
#include <pelorus/parts.hpp>

namespace test_support {

/// The plugin `kind.name`, from PELORUS_PLUGIN_DIR/kind/name.so.
inline const plr_plugin& plugin(const std::string& kind, const std::string& name) {
    const std::string file = std::string(PELORUS_PLUGIN_DIR) + "/" + kind + "/" + name + ".so";
    void* const library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) throw std::runtime_error(dlerror());
    const auto* const entry = static_cast<const plr_entry_point*>(dlsym(library, PLR_ENTRY_SYMBOL));
    if (entry == nullptr) throw std::runtime_error(file + " exports no " PLR_ENTRY_SYMBOL);
    const plr_plugin* const found = entry->factory((kind + "." + name).c_str());
    if (found == nullptr) throw std::runtime_error(file + " does not know " + kind + "." + name);
    return *found;
}

/// Parameters by name, each as written in a config: "0.1 1/s", "[10 m, 1 mrad, 1 mrad]", "truncated".
using Values = std::map<std::string, std::string>;

/// Creation was refused; `where` names the parameter or slot.
struct Refused : std::runtime_error {
    explicit Refused(const plr_error& error)
        : std::runtime_error(error.message), code(error.code), where(error.where) {}
    plr_status code;
    std::string where;
};

namespace detail {

inline double number(const char*& text) {
    static const std::map<std::string, double> prefixed{{"km", 1e3}, {"mrad", 1e-3}, {"deg", std::acos(-1.0) / 180.0}};
    char* end = nullptr;
    const double value = std::strtod(text, &end);
    if (end == text) throw std::runtime_error("not a number: " + std::string(text));
    std::string unit;
    for (text = end; *text != 0 && *text != ',' && *text != ']'; ++text) {
        if (*text != ' ') unit += *text;
    }
    const auto factor = prefixed.find(unit);
    return factor == prefixed.end() ? value : value * factor->second;
}

/// One parsed parameter and what it points to.
struct Value {
    plr_value raw{};
    std::string text;
    std::vector<double> numbers;
    std::int64_t columns = 1;

    Value(const plr_parameter& parameter, const Values& given) {
        raw.struct_size = sizeof raw;
        const auto found = given.find(parameter.name);
        if (found == given.end() && parameter.default_text == nullptr) {
            if ((parameter.flags & PLR_PARAMETER_OPTIONAL) == 0)
                throw std::runtime_error(std::string("parameter ") + parameter.name + " is required");
            return;
        }
        text = found == given.end() ? parameter.default_text : found->second;
        parse(parameter);
        raw.present = 1;
        raw.text = text.c_str();
        const auto size = static_cast<std::int64_t>(numbers.size()), rows = size / columns;
        raw.numbers = {numbers.data(), rows, columns, 1, columns == 1 ? 1 : columns, columns == 1 ? rows : 1, size};
    }
    Value(const Value&) = delete;
    Value& operator=(const Value&) = delete;

private:
    void parse(const plr_parameter& parameter) {
        const char* at = text.c_str();
        switch (parameter.type) {
            case PLR_TYPE_INT:
                raw.integer = std::strtol(at, nullptr, 10);
                return;
            case PLR_TYPE_BOOL:
                raw.integer = text == "true";
                return;
            case PLR_TYPE_DOUBLE:
                raw.number = number(at);
                return;
            case PLR_TYPE_CHOICE:
                for (std::uint32_t c = 0; c < parameter.choice_count; ++c) {
                    if (text != parameter.choices[c]) continue;
                    raw.integer = c;
                    return;
                }
                throw std::runtime_error(text + " is no choice of " + parameter.name);
            case PLR_TYPE_VECTOR:
                if (*at != '[') {
                    const bool fixed = parameter.rows_min == parameter.rows_max;
                    numbers.assign(fixed ? static_cast<std::size_t>(parameter.rows_min) : 1, number(at));
                    return;
                }
                do numbers.push_back(number(++at));
                while (*at == ',');
                return;
            case PLR_TYPE_MATRIX:  // [[1, 2], [3, 4]], kept row by row
                for (++at; *at == '['; at += std::strspn(at, ", ")) {
                    columns = 0;
                    do ++columns, numbers.push_back(number(++at));
                    while (*at == ',');
                    ++at;
                }
                return;
            default:
                throw std::runtime_error(std::string("cannot parse the type of ") + parameter.name);
        }
    }
};

}  // namespace detail

/// The random numbers that instances are offered; none unless a test sets them.
inline const plr_random* offered_random = nullptr;

namespace detail {

inline const void* service(const plr_host*, const char* id) {
    return std::strcmp(id, PLR_SERVICE_RANDOM) == 0 ? offered_random : nullptr;
}

}  // namespace detail

/// A living instance and everything it was made from. Parts of its slots must outlive it.
class Instance {
public:
    struct Filled {
        std::string slot, name;
        const Instance* part;
        Values values = {};  ///< of the parameters that the slot declares
    };

    Instance(const std::string& kind, const std::string& name, const Values& values = {},
             std::vector<Filled> slots = {}, std::int64_t input_offset = 0)
        : Instance(plugin(kind, name), values, std::move(slots), input_offset) {}
    Instance(const plr_plugin& plugin, const Values& values, std::vector<Filled> slots, std::int64_t input_offset)
        : plugin_(plugin), slots_(std::move(slots)) {
        const plr_description& description = *plugin.description;
        std::size_t known = 0;
        for (std::uint32_t i = 0; i < description.parameter_count; ++i) {
            values_.push_back(std::make_unique<detail::Value>(description.parameters[i], values));
            raw_values_.push_back(values_.back()->raw);
            known += values.count(description.parameters[i].name);
        }
        if (known != values.size()) throw std::runtime_error("a parameter is not known");
        for (const Filled& filled : slots_) parts_.push_back(filled_part(description, filled));
        host_ = {sizeof host_, PLR_ABI_MAJOR, PLR_ABI_MINOR, "test", nullptr, &detail::service};
        config_.struct_size = sizeof config_;
        config_.address = "test";
        config_.values = raw_values_.data();
        config_.value_count = static_cast<std::uint32_t>(raw_values_.size());
        config_.parts = parts_.data();
        config_.part_count = static_cast<std::uint32_t>(parts_.size());
        config_.input_offset = input_offset;
        config_.frame = "";
        config_.host = &host_;
        plr_error error{};
        error.struct_size = sizeof error;
        if (plugin.create(&config_, &instance_, &error) != PLR_OK) throw Refused(error);
    }
    ~Instance() {
        if (instance_.self != nullptr) instance_.table->destroy(instance_.self);
    }
    Instance(const Instance&) = delete;
    Instance& operator=(const Instance&) = delete;

    plr_part as_part(const std::string& slot, const std::string& name) const {
        return {sizeof(plr_part),    0,         slot.c_str(), name.c_str(), "test", plugin_.table_id,
                plugin_.description, instance_, nullptr};
    }
    /// As its holder calls it: instance.as<pelorus::MotionPart>(). Valid as long as this object.
    template <class PartType> PartType as() const {
        own_ = as_part(empty_, empty_);
        return PartType(own_);
    }

private:
    /// The part with the values of the slot's parameters.
    plr_part filled_part(const plr_description& description, const Filled& filled) {
        plr_part part = filled.part->as_part(filled.slot, filled.name);
        for (std::uint32_t i = 0; i < description.slot_count; ++i) {
            const plr_slot& slot = description.slots[i];
            if (filled.slot != slot.name || slot.parameter_count == 0) continue;
            auto& raw = *slot_values_.emplace_back(std::make_unique<std::vector<plr_value>>());
            for (std::uint32_t p = 0; p < slot.parameter_count; ++p) {
                values_.push_back(std::make_unique<detail::Value>(slot.parameters[p], filled.values));
                raw.push_back(values_.back()->raw);
            }
            part.values = raw.data();
            part.value_count = slot.parameter_count;
        }
        return part;
    }

    const plr_plugin& plugin_;
    std::vector<Filled> slots_;
    std::vector<std::unique_ptr<detail::Value>> values_;
    std::vector<plr_value> raw_values_;
    std::vector<std::unique_ptr<std::vector<plr_value>>> slot_values_;
    std::vector<plr_part> parts_;
    plr_host host_{};
    plr_config config_{};
    plr_instance instance_{};
    std::string empty_;
    mutable plr_part own_{};
};

/// Memory that is lent to one call after the other: megabytes that are asked for anew take more time than most calls do.
class ScratchMemory {
public:
    ScratchMemory() {
        if (free().empty()) free().push_back(std::make_unique<Line[]>(bytes / sizeof(Line)));
        lines_ = std::move(free().back());
        free().pop_back();
    }
    ~ScratchMemory() { free().push_back(std::move(lines_)); }
    ScratchMemory(const ScratchMemory&) = delete;
    ScratchMemory& operator=(const ScratchMemory&) = delete;

    plr_scratch scratch() const noexcept { return {lines_[0].bytes, bytes, 0}; }

private:
    struct alignas(64) Line {
        unsigned char bytes[64];
    };
    static constexpr std::size_t bytes = 2048 * 1024;
    static std::vector<std::unique_ptr<Line[]>>& free() {
        static thread_local std::vector<std::unique_ptr<Line[]>> lines;
        return lines;
    }

    std::unique_ptr<Line[]> lines_;
};

/// The context of a call, with room for `count` item statuses and scratch memory.
class Call {
public:
    explicit Call(std::int64_t count = 1)
        : status_(static_cast<std::size_t>(count), PLR_OK), scratch_(memory_.scratch()) {
        error_.struct_size = sizeof error_;
        error_.item = -1;
        call_.struct_size = sizeof call_;
        call_.scratch = &scratch_;
        call_.error = &error_;
        call_.item_status = status_.data();
    }
    Call(const Call&) = delete;
    Call& operator=(const Call&) = delete;

    void inputs(const double* values, std::int64_t stride = 0) {
        call_.inputs = values;
        call_.input_stride = stride;
    }
    operator const plr_call&() const noexcept { return call_; }
    plr_call& raw() noexcept { return call_; }
    plr_status status(std::size_t item = 0) const { return status_[item]; }
    std::string message() const { return error_.message; }
    const plr_error& error() const noexcept { return error_; }
    std::uint64_t scratch_used() const noexcept { return scratch_.used; }

private:
    std::vector<plr_status> status_;
    ScratchMemory memory_;
    plr_scratch scratch_;
    plr_error error_{};
    plr_call call_{};
};

/// Doubles of a batch of rows x cols matrices, and views of them.
struct Batch {
    Batch(std::int64_t rows_, std::int64_t cols_, std::int64_t count_ = 1)
        : rows(rows_),
          cols(cols_),
          count(count_),
          numbers(static_cast<std::size_t>(rows_ * cols_ * count_), std::numeric_limits<double>::quiet_NaN()) {}
    plr_view out() { return pelorus::view(numbers.data(), rows, cols, count); }
    plr_const_view in() const { return pelorus::const_view(numbers.data(), rows, cols, count); }
    Eigen::Map<Eigen::MatrixXd> operator[](std::int64_t item) {
        return {numbers.data() + item * rows * cols, rows, cols};
    }

    std::int64_t rows, cols, count;
    std::vector<double> numbers;
};

}  // namespace test_support

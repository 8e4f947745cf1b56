#include "creation.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include "library.hpp"
#include "watch.hpp"

namespace pelorus::conformance {

namespace {

constexpr double largest_count = 1e4;  // more elements, particles, threads ... are a matter of load, not of values

bool has_numbers(const plr_parameter& parameter) noexcept {
    return parameter.type == PLR_TYPE_DOUBLE || parameter.type == PLR_TYPE_VECTOR || parameter.type == PLR_TYPE_MATRIX;
}

std::string title_of(const plr_parameter& parameter, double number) {
    char text[64];
    std::snprintf(text, sizeof text, ": %.17g", number);
    const bool is_many = parameter.type == PLR_TYPE_VECTOR || parameter.type == PLR_TYPE_MATRIX;
    return std::string(parameter.name) + (is_many ? " (each element)" : "") + text;
}

/// The bounds of a parameter of numbers and what lies just inside them.
std::vector<double> bounds_of(const plr_parameter& parameter) {
    std::vector<double> found;
    const auto add = [&](double bound, double inwards, bool is_exclusive) {
        if (!std::isfinite(bound)) return;
        const bool is_whole = parameter.type == PLR_TYPE_INT;
        if (is_whole && std::abs(bound) > largest_count) return;
        if (!is_exclusive) found.push_back(bound);
        found.push_back(is_whole ? bound + inwards : std::nextafter(bound, inwards * HUGE_VAL));
    };
    add(parameter.min, 1, (parameter.flags & PLR_PARAMETER_MIN_EXCLUSIVE) != 0);
    add(parameter.max, -1, (parameter.flags & PLR_PARAMETER_MAX_EXCLUSIVE) != 0);
    found.erase(std::remove_if(found.begin(), found.end(),
                               [&](double value) { return value < parameter.min || value > parameter.max; }),
                found.end());
    return found;
}

}  // namespace

Creation::Creation(const plr_plugin& plugin, const plr_config& config) {
    plr_error error = empty_error();
    call(plugin, config, error, -1);
}

Creation::Creation(const plr_plugin& plugin, const plr_config& config, plr_error& error) {
    call(plugin, config, error, -1);
}

Creation Creation::with_failing_allocation(const plr_plugin& plugin, const plr_config& config, std::int64_t n) {
    Creation made;
    plr_error error = empty_error();
    made.call(plugin, config, error, n);
    return made;
}

void Creation::call(const plr_plugin& plugin, const plr_config& config, plr_error& error, std::int64_t failing) {
    std::int64_t left = -1;
    try {
        watch::fail_allocation(failing);
        status_ = plugin.create(&config, &instance_, &error);
        left = watch::fail_allocation(-1);
    } catch (...) {
        left = watch::fail_allocation(-1);
        left_by_ = exception_text();
    }
    has_failed_allocation_ = failing >= 0 && left < 0;
    error_ = error;
}

Creation::Creation(Creation&& other) noexcept
    : status_(other.status_),
      error_(other.error_),
      instance_(std::exchange(other.instance_, plr_instance{})),
      left_by_(std::move(other.left_by_)),
      has_failed_allocation_(other.has_failed_allocation_) {}

Creation::~Creation() {
    if (is_made() && instance_.table->destroy != nullptr) instance_.table->destroy(instance_.self);
}

std::string Creation::told() const {
    return left_by_.empty() ? conformance::told(status_, error_) : "create was left by " + left_by_;
}

AlteredConfig::AlteredConfig(const Instance& instance)
    : config_(instance.config()),
      values_(config_.values, config_.values + config_.value_count),
      numbers_(config_.value_count),
      text_(config_.value_count),
      texts_(config_.value_count),
      description_(instance.description()) {
    config_.values = values_.data();
}

bool AlteredConfig::set(std::uint32_t parameter, double number) {
    const plr_parameter& described = element_of(description_.parameters, parameter);
    plr_value& value = values_[parameter];
    if (described.type == PLR_TYPE_DOUBLE) {
        value.number = number;
        value.present = 1;
        return true;
    }
    if (described.type != PLR_TYPE_VECTOR && described.type != PLR_TYPE_MATRIX) return false;
    const std::int64_t size = value.numbers.rows * value.numbers.cols;
    if (value.present == 0 || size == 0) return false;
    std::vector<double>& own = numbers_[parameter];
    own.assign(static_cast<std::size_t>(size), number);
    value.numbers.data = own.data();
    return true;
}

bool AlteredConfig::set_integer(std::uint32_t parameter, std::int64_t integer) {
    const plr_parameter& described = element_of(description_.parameters, parameter);
    plr_value& value = values_[parameter];
    value.integer = integer;
    value.present = 1;
    if (described.type == PLR_TYPE_CHOICE) value.text = described.choices[integer];
    return true;
}

bool AlteredConfig::set_text(std::uint32_t parameter, std::string text) {
    text_[parameter] = std::move(text);
    values_[parameter].text = text_[parameter].c_str();
    values_[parameter].present = 1;
    return true;
}

bool AlteredConfig::set_rows(std::uint32_t parameter, std::int64_t rows) {
    plr_value& value = values_[parameter];
    const std::int64_t given = value.numbers.rows, columns = value.numbers.cols;
    if (value.present == 0 || given == 0) return false;
    std::vector<double> numbers(static_cast<std::size_t>(rows * columns));
    std::vector<const char*> texts(numbers.size());
    for (std::int64_t r = 0; r < rows; ++r)
        for (std::int64_t k = 0; k < columns; ++k) {
            numbers[static_cast<std::size_t>(k * rows + r)] =
                value.numbers.data[k * value.numbers.col_stride + (r % given) * value.numbers.row_stride];
            texts[static_cast<std::size_t>(r * columns + k)] = value.texts[(r % given) * columns + k];
        }
    numbers_[parameter] = std::move(numbers);
    texts_[parameter] = std::move(texts);
    value.numbers = {numbers_[parameter].data(), rows, columns, 1, 1, std::max<std::int64_t>(rows, 1), rows * columns};
    value.texts = texts_[parameter].data();
    return true;
}

bool AlteredConfig::set_column(std::uint32_t parameter, std::uint32_t column, double number) {
    const std::int64_t rows = values_[parameter].numbers.rows;
    if (!set_rows(parameter, rows)) return false;
    std::fill_n(numbers_[parameter].begin() + column * rows, rows, number);
    return true;
}

namespace {

const std::string long_text(5000, 'x');

/// Texts that are no one's plain word.
std::vector<std::pair<std::string, std::string>> texts_for(const plr_parameter& parameter) {
    std::vector<std::pair<std::string, std::string>> texts{
        {"\"\"", ""}, {"5000 times x", long_text}, {"%s%n \"quoted\" {braces}", "%s%n \"quoted\" {braces}"}};
    if (parameter.type == PLR_TYPE_PATH) {
        texts.emplace_back("/", "/");
        texts.emplace_back("no/such/folder/file", "no/such/folder/file");
    } else {
        texts.emplace_back("bytes that are no UTF-8", "\xC3\x28\xFF");
    }
    return texts;
}

/// As few rows as may be, twice those given, and each column of numbers at its bounds.
void add_table_trials(std::uint32_t index, const plr_parameter& parameter, std::vector<Trial>& trials) {
    const auto rows = [&](std::int64_t count) {
        trials.push_back(
            {index, std::string(parameter.name) + ": " + std::to_string(count) + " rows", static_cast<double>(count)});
    };
    constexpr std::int64_t many = 40;
    rows(parameter.rows_min);
    rows(parameter.rows_max < 0 ? parameter.rows_min + many : std::min<std::int64_t>(parameter.rows_max, many));
    for (std::uint32_t k = 0; k < parameter.column_count; ++k) {
        const plr_parameter& column = element_of(parameter.columns, k);
        if (column.type != PLR_TYPE_DOUBLE && column.type != PLR_TYPE_INT) continue;
        for (const double bound : bounds_of(column))
            trials.push_back({index, std::string(parameter.name) + "." + title_of(column, bound), bound, "", k});
    }
}

}  // namespace

std::vector<Trial> trials_within(const plr_description& description) {
    std::vector<Trial> trials;
    for (std::uint32_t p = 0; p < description.parameter_count; ++p) {
        const plr_parameter& parameter = element_of(description.parameters, p);
        if (has_numbers(parameter) || parameter.type == PLR_TYPE_INT) {
            for (const double bound : bounds_of(parameter)) trials.push_back({p, title_of(parameter, bound), bound});
        } else if (parameter.type == PLR_TYPE_BOOL) {
            for (const double value : {0.0, 1.0}) trials.push_back({p, title_of(parameter, value), value});
        } else if (parameter.type == PLR_TYPE_CHOICE) {
            for (std::uint32_t c = 0; c < parameter.choice_count; ++c)
                trials.push_back({p, std::string(parameter.name) + ": " + parameter.choices[c], double{1} * c});
        } else if (parameter.type == PLR_TYPE_STRING || parameter.type == PLR_TYPE_PATH) {
            for (const auto& [title, text] : texts_for(parameter))
                trials.push_back({p, std::string(parameter.name) + ": " + title, 0, text});
        } else if (parameter.type == PLR_TYPE_TABLE) {
            add_table_trials(p, parameter, trials);
        }
    }
    return trials;
}

std::vector<Trial> trials_outside(const plr_description& description) {
    std::vector<Trial> trials;
    for (std::uint32_t p = 0; p < description.parameter_count; ++p) {
        const plr_parameter& parameter = element_of(description.parameters, p);
        if (!has_numbers(parameter)) continue;  // counts index memory; a host that does not check them is no host
        std::vector<double> values{std::numeric_limits<double>::quiet_NaN(), HUGE_VAL, -HUGE_VAL};
        if (std::isfinite(parameter.min)) values.push_back(parameter.min - 1);
        if (std::isfinite(parameter.max)) values.push_back(parameter.max + 1);
        for (const double value : values) trials.push_back({p, title_of(parameter, value), value});
    }
    return trials;
}

bool apply(const Trial& trial, const plr_description& description, AlteredConfig& config) {
    const plr_parameter& parameter = element_of(description.parameters, trial.parameter);
    if (has_numbers(parameter)) return config.set(trial.parameter, trial.number);
    if (parameter.type == PLR_TYPE_STRING || parameter.type == PLR_TYPE_PATH)
        return config.set_text(trial.parameter, trial.text);
    const auto whole = static_cast<std::int64_t>(trial.number);
    if (parameter.type != PLR_TYPE_TABLE) return config.set_integer(trial.parameter, whole);
    return trial.column < 0
               ? config.set_rows(trial.parameter, whole)
               : config.set_column(trial.parameter, static_cast<std::uint32_t>(trial.column), trial.number);
}

}  // namespace pelorus::conformance

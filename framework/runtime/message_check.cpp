#include "runtime/message_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include <fmt/format.h>
#include <pelorus/abi/consistency.h>

#include "host/kinds.hpp"
#include "runtime/message_fields.hpp"

namespace pelorus::runtime {
namespace {

constexpr std::int64_t largest_count = std::int64_t{1} << 34;  // numbers in one field: 128 GiB

/// Keeps the path to the field at hand without allocating while all is well.
class Checker {
public:
    explicit Checker(const char* root) { levels_[0] = {root, -1}; }

    template <class Struct> void check_struct(const Struct* given) {
        if (!given) fail("", "is NULL");
        if (given->struct_size < first_size<Struct>)
            fail("struct_size", fmt::format("is {}, expected at least {}", given->struct_size, first_size<Struct>));
        if (given->struct_size % alignof(Struct) != 0)
            fail("struct_size", fmt::format("is {}, expected a multiple of {}", given->struct_size, alignof(Struct)));
    }

    template <class Number> void value(Number&) {}

    void count(const char* field, std::int64_t& n) const {
        if (n < 0 || n > largest_count) fail(field, fmt::format("is {}, expected 0 to {}", n, largest_count));
    }

    void text(const char* field, const char*& given) const {
        if (!given) fail(field, "is NULL, expected a string");
    }
    void text_or_null(const char*, const char*&) const {}
    void texts(const char* field, const char* const*& given, std::uint32_t n) const {
        if (!given) return;
        for (std::uint32_t i = 0; i < n; ++i)
            if (!given[i]) fail(field, "is NULL, expected a string", i);
    }

    template <class Number> void array(const char* field, const Number*& given, std::int64_t n, unsigned flags) const {
        if (!given && n > 0 && !(flags & field_optional)) fail(field, fmt::format("is NULL, expected {} entries", n));
    }

    std::int64_t offsets(const char* field, const std::int64_t*& given, std::int64_t n, unsigned) const {
        if (!given || n == 0) return 0;
        if (given[0] != 0) fail(field, fmt::format("begins with {}, expected 0", given[0]), 0);
        for (std::int64_t i = 0; i < n; ++i)
            if (given[i + 1] < given[i])
                fail(field, fmt::format("falls from {} to {}, expected an ascending list", given[i], given[i + 1]),
                     i + 1);
        if (given[n] > largest_count)
            fail(field, fmt::format("ends with {}, expected at most {}", given[n], largest_count), n);
        return given[n];
    }

    void view(const char* field, plr_const_view& given, std::int64_t rows, std::int64_t cols, std::int64_t n,
              unsigned flags) const {
        if (!given.data) {
            if (n > 0 && rows != 0 && !(flags & field_optional) && (rows != any_size || given.rows * given.cols != 0))
                fail(field, "is NULL");
            return;
        }
        if (n == 0) return;
        const bool fits = given.count == n && (rows == any_size ? given.rows >= 0 : given.rows == rows) &&
                          (cols == any_size ? given.cols >= 0 : given.cols == cols);
        if (!fits)
            fail(field, fmt::format("is {} x {} x {}, expected {} x {} x {}", given.rows, given.cols, given.count,
                                    size_text(rows), size_text(cols), n));
        std::int64_t numbers = 0;
        if (__builtin_mul_overflow(given.rows, given.cols, &numbers) || __builtin_mul_overflow(numbers, n, &numbers) ||
            numbers > largest_count)
            fail(field, fmt::format("is {} x {} x {}: more than {} numbers", given.rows, given.cols, given.count,
                                    largest_count));
        if ((flags & field_shape) && (given.rows != given.cols || given.rows < 1 || given.rows > 3))
            fail(field, fmt::format("is {} x {}, expected 1 x 1, 2 x 2 or 3 x 3", given.rows, given.cols));
        if (flags & field_finite) check_finite(field, given);
    }

    std::int64_t space(const char* field, const plr_space*& given, unsigned flags) {
        if (!given && (flags & field_optional)) return 0;
        const Level outer(*this, field);
        check_struct(given);
        if (given->size < 1) fail("", "has no components");
        elements("components", given->components, given->size);
        return given->size;
    }

    template <class Struct> void elements(const char* field, const Struct* first, std::uint32_t n) {
        if (n == 0) return;
        if (!first) fail(field, fmt::format("is NULL, expected {} entries", n));
        const Level level(*this, field);
        check_struct(first);
        for (std::uint32_t i = 0; i < n; ++i) {
            levels_[depth_].index = i;
            Struct element = known_element(first, i);
            visit_fields(*this, element);
            check_element(element);
        }
    }

    [[noreturn]] void fail(const char* field, const std::string& what, std::int64_t entry = -1) const {
        std::string path;
        for (std::size_t i = 0; i <= depth_; ++i) {
            if (i) path += '.';
            path += levels_[i].name;
            if (levels_[i].index >= 0) path += fmt::format("[{}]", levels_[i].index);
        }
        if (*field) path += std::string(".") + field;
        if (entry >= 0) path += fmt::format("[{}]", entry);
        std::int64_t item = entry;
        for (std::size_t i = depth_ + 1; item < 0 && i-- > 0;) item = levels_[i].index;
        throw BadMessage(path + ' ' + what, item);
    }

private:
    struct Place {
        const char* name;
        std::int64_t index;
    };
    class Level {
    public:
        Level(Checker& checker, const char* name) : checker_(checker) {
            checker_.levels_.at(++checker_.depth_) = {name, -1};
        }
        Level(const Level&) = delete;
        Level& operator=(const Level&) = delete;
        ~Level() { --checker_.depth_; }

    private:
        Checker& checker_;
    };

    static std::string size_text(std::int64_t size) { return size == any_size ? "any" : std::to_string(size); }

    void check_finite(const char* field, const plr_const_view& given) const {
        const std::int64_t items = given.item_stride == 0 ? std::min<std::int64_t>(given.count, 1) : given.count;
        for (std::int64_t i = 0; i < items; ++i)
            for (std::int64_t col = 0; col < given.cols; ++col)
                for (std::int64_t row = 0; row < given.rows; ++row) {
                    const double x =
                        given.data[i * given.item_stride + col * given.col_stride + row * given.row_stride];
                    if (!std::isfinite(x))
                        fail(field, fmt::format("has {} at ({}, {}), expected finite numbers", x, row, col), i);
                }
    }

    void check_element(const plr_component& component) const {
        if (!*component.name) fail("name", "is empty");
    }
    void check_element(const plr_quantity& quantity) const {
        if (!*quantity.name) fail("name", "is empty");
        if (quantity.valid_from > quantity.valid_to)
            fail("valid_from", fmt::format("is {}, after valid_to {}", quantity.valid_from, quantity.valid_to));
        if (!quantity.ids && quantity.numbers.count > 1)
            fail("numbers", fmt::format("has {} items, expected 1 where there are no ids", quantity.numbers.count));
    }
    void check_element(const plr_column& column) const {
        if (!*column.name) fail("name", "is empty");
        check_reduce(column.reduce, column.quantile);
    }
    void check_element(const plr_scalar& scalar) const {
        if (!*scalar.name) fail("name", "is empty");
        if (!scalar.column) check_reduce(scalar.reduce, scalar.quantile);
        if (!(scalar.weight >= 0) || std::isinf(scalar.weight))
            fail("weight", fmt::format("is {}, expected a finite number >= 0", scalar.weight));
    }
    void check_reduce(std::uint32_t reduce, double quantile) const {
        if (reduce > PLR_REDUCE_CHI_SQUARE)
            fail("reduce", fmt::format("is {}, expected one of PLR_REDUCE_... (0 to {})", reduce,
                                       static_cast<int>(PLR_REDUCE_CHI_SQUARE)));
        if (reduce == PLR_REDUCE_QUANTILE && !(quantile >= 0 && quantile <= 1))
            fail("quantile", fmt::format("is {}, expected 0 to 1", quantile));
        if (reduce == PLR_REDUCE_CHI_SQUARE && !(quantile > 0 && quantile < 1))
            fail("quantile", fmt::format("is {}, expected more than 0 and less than 1", quantile));
    }

    std::array<Place, 5> levels_{};
    std::size_t depth_ = 0;
};

/// Entries that share id and time. Ascending ids, the usual case, cost one pass.
void check_unique(const Checker& checker, const std::uint64_t* ids, const std::int64_t* times, std::int64_t n,
                  CheckMemory& memory) {
    bool ascending = true;
    for (std::int64_t i = 1; i < n && ascending; ++i) ascending = ids[i - 1] < ids[i];
    if (ascending) return;
    memory.entries.clear();
    for (std::int64_t i = 0; i < n; ++i) memory.entries.push_back({ids[i], times ? times[i] : 0, i});
    const auto key = [](const CheckMemory::Entry& entry) { return std::tie(entry.id, entry.time, entry.index); };
    std::sort(memory.entries.begin(), memory.entries.end(),
              [&](const auto& a, const auto& b) { return key(a) < key(b); });
    for (std::size_t i = 1; i < memory.entries.size(); ++i) {
        const auto &first = memory.entries[i - 1], &second = memory.entries[i];
        if (first.id == second.id && first.time == second.time)
            checker.fail(
                "ids", fmt::format("is {}, as entry {} is{}", first.id, first.index, times ? ", at the same time" : ""),
                second.index);
    }
}

void check_whole(const Checker& checker, const plr_scan& scan, CheckMemory& memory) {
    // Several measurements with one id could not be told apart by whoever scores the association.
    check_unique(checker, scan.ids, nullptr, scan.measurements.count, memory);
}

void check_whole(const Checker& checker, const plr_tracks& tracks, CheckMemory& memory) {
    for (std::int64_t i = 0; i < tracks.count; ++i) {
        if (tracks.status[i] < PLR_TRACK_TENTATIVE || tracks.status[i] > PLR_TRACK_DELETED)
            checker.fail("status", fmt::format("is {}, expected one of PLR_TRACK_... (0 to 3)", tracks.status[i]), i);
        if (tracks.misses[i] < 0) checker.fail("misses", fmt::format("is {}, expected 0 or more", tracks.misses[i]), i);
    }
    check_unique(checker, tracks.ids, tracks.times, tracks.count, memory);
}

void check_whole(const Checker& checker, const plr_truth& truth, CheckMemory& memory) {
    check_unique(checker, truth.ids, truth.times, truth.count, memory);
}

void check_whole(const Checker&, const plr_values&, CheckMemory&) {}

void check_text_column(const Checker& checker, const plr_table& table, const plr_column& column, std::uint32_t index) {
    for (std::int64_t row = 0; row < table.rows.count; ++row) {
        const double x = table.rows.data[row * table.rows.item_stride + index * table.rows.row_stride];
        if (std::isfinite(x) && !(x >= 0 && x < column.text_count && x == std::floor(x)))
            checker.fail("rows",
                         fmt::format("has {} in text column {}, expected an index into its {} texts", x, column.name,
                                     column.text_count),
                         row);
    }
}

void check_whole(const Checker& checker, const plr_table& table, CheckMemory&) {
    if (table.rows.count > 0 && table.column_count == 0)
        checker.fail("rows", fmt::format("has {} rows but the table has no columns", table.rows.count));
    for (std::uint32_t i = 0; i < table.column_count; ++i) {
        const plr_column column = known_element(table.columns, i);
        for (std::uint32_t j = 0; j < i; ++j)
            if (std::strcmp(column.name, known_element(table.columns, j).name) == 0)
                checker.fail("columns", fmt::format("has the name {} twice", column.name), i);
        if (column.texts) check_text_column(checker, table, column, i);
    }
    for (std::uint32_t i = 0; i < table.scalar_count; ++i) {
        const plr_scalar scalar = known_element(table.scalars, i);
        for (std::uint32_t j = 0; j < i; ++j)
            if (std::strcmp(scalar.name, known_element(table.scalars, j).name) == 0)
                checker.fail("scalars", fmt::format("has the name {} twice", scalar.name), i);
        if (!scalar.column) continue;
        bool found = false;
        for (std::uint32_t j = 0; j < table.column_count; ++j) {
            const plr_column column = known_element(table.columns, j);
            found = found || (std::strcmp(scalar.column, column.name) == 0 && !column.texts);
        }
        if (!found)
            checker.fail("scalars",
                         fmt::format("names the column {}, which is not a numeric column of the table", scalar.column),
                         i);
    }
}

template <class Body> void check_body(const char* root, const Body* given, CheckMemory& memory) {
    Checker checker(root);
    checker.check_struct(given);
    Body body = known_part(given);
    visit_fields(checker, body);
    check_whole(checker, body, memory);
}

std::string space_text(const plr_space& space) {
    std::string text;
    for (std::uint32_t i = 0; i < space.size; ++i) {
        const plr_component component = known_element(space.components, i);
        text += fmt::format("{}{} [{}]", i ? ", " : "", component.name, component.unit);
    }
    return '(' + text + ')';
}

std::string stream_text(const char* sensor, const plr_space* space, const char* frame) {
    return fmt::format("sensor \"{}\", frame \"{}\", space {}", sensor ? sensor : "", frame ? frame : "",
                       space ? space_text(*space) : "(any)");
}

}  // namespace

void check_message(const plr_message& message, CheckMemory& memory) {
    Checker("message").check_struct(&message);
    switch (message.kind) {
        case PLR_MESSAGE_SCAN:
            return check_body("scan", message.body.scan, memory);
        case PLR_MESSAGE_TRACKS:
            return check_body("tracks", message.body.tracks, memory);
        case PLR_MESSAGE_TRUTH:
            return check_body("truth", message.body.truth, memory);
        case PLR_MESSAGE_VALUES:
            return check_body("values", message.body.values, memory);
        case PLR_MESSAGE_TABLE:
            return check_body("table", message.body.table, memory);
        default:
            throw BadMessage(fmt::format("message.kind is {}, expected one of PLR_MESSAGE_... (1 to 5)", message.kind));
    }
}

bool same_space(const plr_space& one, const plr_space& other) {
    if (&one == &other) return true;
    if (one.size != other.size) return false;
    for (std::uint32_t i = 0; i < one.size; ++i) {
        const plr_component a = known_element(one.components, i), b = known_element(other.components, i);
        if (std::strcmp(a.name, b.name) != 0 || std::strcmp(a.unit, b.unit) != 0) return false;
    }
    return true;
}

void check_stream(const plr_message& message, const std::vector<plr_stream>& declared) {
    if (declared.empty()) return;
    const char *sensor = "", *frame = "";
    const plr_space* space = nullptr;
    switch (message.kind) {
        case PLR_MESSAGE_SCAN:
            sensor = message.body.scan->sensor, frame = message.body.scan->frame, space = message.body.scan->space;
            break;
        case PLR_MESSAGE_TRACKS:
            frame = message.body.tracks->frame, space = message.body.tracks->space;
            break;
        case PLR_MESSAGE_TRUTH:
            frame = message.body.truth->frame, space = message.body.truth->space;
            break;
        default:
            return;
    }
    std::string offers;
    for (const plr_stream& stream : declared) {
        const bool right_sensor =
            message.kind != PLR_MESSAGE_SCAN || !stream.sensor || std::strcmp(stream.sensor, sensor) == 0;
        if (right_sensor && (!stream.frame || std::strcmp(stream.frame, frame) == 0) &&
            (!stream.space || same_space(*stream.space, *space)))
            return;
    }
    for (const plr_stream& stream : declared) offers += "; " + stream_text(stream.sensor, stream.space, stream.frame);
    throw BadMessage(fmt::format("the {} has {}, but the port declared {}", host::message_kind_name(message.kind),
                                 stream_text(sensor, space, frame), offers.substr(2)));
}

}  // namespace pelorus::runtime

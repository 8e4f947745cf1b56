/// The fields of every message, told once. Checking, copying, writing to bytes and reading back are visitors of this
/// list, so that they cannot disagree.
///
/// A visitor has
///     value(x)                                   a number that stands in the struct itself
///     count(field, n)                            the same, a number of entries (>= 0)
///     text(field, s)                             a string, never NULL
///     text_or_null(field, s)                     a string or NULL
///     texts(field, s, n)                         n strings, or NULL
///     array(field, a, n, flags)                  n numbers
///     offsets(field, a, n, flags) -> last        n + 1 offsets into another array; answers its length
///     view(field, v, rows, cols, n, flags)       a batch of n matrices; any_size: as the view says
///     space(field, s, flags) -> components
///     elements(field, a, n)                      n structs that may be larger than ours
/// and is called with a copy of the struct, whose pointers it may replace.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>

#include <pelorus/abi/abi.h>

#include "host/first_size.hpp"

namespace pelorus::runtime {

enum FieldFlags : unsigned {
    field_required = 0,
    field_optional = 1u << 0,  ///< NULL: not given
    field_finite = 1u << 1,    ///< every element is finite
    field_common = 1u << 2,    ///< item_stride 0 is kept: one matrix for all items
    field_shape = 1u << 3      ///< square, 1 to 3 rows
};

constexpr std::int64_t any_size = -1;

using host::first_size;  // fields that came later read as zero

/// What we know of a struct that may be smaller or larger than ours.
template <class Struct> Struct known_part(const void* from, std::uint32_t struct_size) {
    Struct known{};
    std::memcpy(&known, from, std::min<std::size_t>(struct_size, sizeof(Struct)));
    known.struct_size = sizeof(Struct);
    return known;
}
template <class Struct> Struct known_part(const Struct* from) { return known_part<Struct>(from, from->struct_size); }
/// Element `index` of an array whose elements have the size that its first one says.
template <class Struct> Struct known_element(const Struct* first, std::uint64_t index) {
    const std::uint32_t stride = first->struct_size;
    return known_part<Struct>(reinterpret_cast<const unsigned char*>(first) + index * stride, stride);
}

template <class Visitor> void visit_fields(Visitor& visitor, plr_component& component) {
    visitor.value(component.flags);
    visitor.text("name", component.name);
    visitor.text("unit", component.unit);
    visitor.value(component.prior_mean);
    visitor.value(component.prior_deviation);
}

template <class Visitor> void visit_fields(Visitor& visitor, plr_scan& scan) {
    visitor.text("sensor", scan.sensor);
    visitor.text("frame", scan.frame);
    const std::int64_t size = visitor.space("space", scan.space, field_required);
    std::int64_t count = scan.measurements.count;
    visitor.count("measurements.count", count);
    visitor.view("measurements", scan.measurements, size, 1, count, field_finite);
    visitor.view("covariances", scan.covariances, size, size, count, field_optional | field_finite | field_common);
    visitor.array("ids", scan.ids, count, field_required);
    visitor.array("times", scan.times, count, field_optional);
    visitor.view("snr", scan.snr, 1, 1, count, field_optional | field_finite);
    const std::int64_t parameters = visitor.space("waveform_space", scan.waveform_space, field_optional);
    visitor.view("waveform", scan.waveform, parameters, 1, 1, field_optional | field_finite);
}

template <class Visitor> void visit_fields(Visitor& visitor, plr_tracks& tracks) {
    visitor.value(tracks.record_version);
    visitor.count("count", tracks.count);
    const std::int64_t count = tracks.count;
    visitor.text("frame", tracks.frame);
    const std::int64_t size = visitor.space("space", tracks.space, field_required);
    visitor.array("ids", tracks.ids, count, field_required);
    visitor.array("times", tracks.times, count, field_required);
    visitor.array("status", tracks.status, count, field_required);
    visitor.array("misses", tracks.misses, count, field_required);
    visitor.view("mean", tracks.mean, size, 1, count, field_finite);
    visitor.view("covariance", tracks.covariance, size, size, count, field_finite);
    visitor.view("extent", tracks.extent, any_size, any_size, count, field_optional | field_finite | field_shape);
    const std::int64_t parents = visitor.offsets("parent_offsets", tracks.parent_offsets, count, field_optional);
    visitor.array("parents", tracks.parents, parents, field_required);
    visitor.array("groups", tracks.groups, count, field_optional);
    const std::int64_t used = visitor.offsets("measurement_offsets", tracks.measurement_offsets, count, field_optional);
    visitor.array("measurements", tracks.measurements, used, field_required);
    visitor.view("records", tracks.records, any_size, 1, count, field_optional);
    visitor.text_or_null("record_of", tracks.record_of);
    visitor.array("measurement_distances", tracks.measurement_distances, used, field_optional);
    visitor.array("measurement_weights", tracks.measurement_weights, used, field_optional);
}

template <class Visitor> void visit_fields(Visitor& visitor, plr_truth& truth) {
    visitor.count("count", truth.count);
    const std::int64_t count = truth.count;
    visitor.text("frame", truth.frame);
    const std::int64_t size = visitor.space("space", truth.space, field_required);
    visitor.array("ids", truth.ids, count, field_required);
    visitor.array("times", truth.times, count, field_required);
    visitor.view("state", truth.state, size, 1, count, field_finite);
    visitor.view("extent", truth.extent, any_size, any_size, count, field_optional | field_finite | field_shape);
    visitor.array("parents", truth.parents, count, field_optional);
    visitor.array("births", truth.births, count, field_optional);
    const std::int64_t seen = visitor.offsets("measurement_offsets", truth.measurement_offsets, count, field_optional);
    visitor.array("measurements", truth.measurements, seen, field_required);
}

template <class Visitor> void visit_fields(Visitor& visitor, plr_quantity& quantity) {
    visitor.text("address", quantity.address);
    visitor.text("name", quantity.name);
    visitor.text("unit", quantity.unit);
    std::int64_t count = quantity.numbers.count;
    visitor.count("numbers.count", count);
    visitor.view("numbers", quantity.numbers, any_size, any_size, count, field_finite);
    visitor.array("ids", quantity.ids, count, field_optional);
    visitor.value(quantity.valid_from);
    visitor.value(quantity.valid_to);
}

template <class Visitor> void visit_fields(Visitor& visitor, plr_values& values) {
    visitor.value(values.count);
    visitor.elements("quantities", values.quantities, values.count);
}

template <class Visitor> void visit_fields(Visitor& visitor, plr_column& column) {
    visitor.value(column.reduce);
    visitor.text("name", column.name);
    visitor.text("unit", column.unit);
    visitor.value(column.quantile);
    visitor.value(column.text_count);
    visitor.texts("texts", column.texts, column.text_count);
}

template <class Visitor> void visit_fields(Visitor& visitor, plr_scalar& scalar) {
    visitor.value(scalar.reduce);
    visitor.text("name", scalar.name);
    visitor.text("unit", scalar.unit);
    visitor.value(scalar.value);
    visitor.value(scalar.quantile);
    visitor.text_or_null("column", scalar.column);
    visitor.value(scalar.weight);
}

template <class Visitor> void visit_fields(Visitor& visitor, plr_table& table) {
    visitor.text("name", table.name);
    visitor.value(table.column_count);
    visitor.elements("columns", table.columns, table.column_count);
    std::int64_t rows = table.rows.count;
    visitor.count("rows.count", rows);
    visitor.view("rows", table.rows, table.column_count, 1, rows, field_required);
    visitor.value(table.scalar_count);
    visitor.elements("scalars", table.scalars, table.scalar_count);
}

}  // namespace pelorus::runtime

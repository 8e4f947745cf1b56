/// Every field of a message, visited one by one: to copy it, or to put it into words.
///
/// A visitor has text(name, const char*&), array(name, const T*&, count), view(name, plr_const_view&), number(name, T&),
/// space(name, const plr_space*&) and elements(name, const Struct*&, count), which visits the elements in its turn.
#pragma once

#include <cstdint>

#include <pelorus/abi/message.h>

namespace pelorus::conformance {

template <class Visitor> void visit_fields(Visitor& v, plr_component& c) {
    v.number("flags", c.flags);
    v.text("name", c.name);
    v.text("unit", c.unit);
    v.number("prior_mean", c.prior_mean);
    v.number("prior_deviation", c.prior_deviation);
}

template <class Visitor> void visit_fields(Visitor& v, plr_space& s) { v.elements("components", s.components, s.size); }

template <class Visitor> void visit_fields(Visitor& v, plr_scan& s) {
    v.text("sensor", s.sensor);
    v.text("frame", s.frame);
    v.space("space", s.space);
    v.view("measurements", s.measurements);
    v.view("covariances", s.covariances);
    v.array("ids", s.ids, s.measurements.count);
    v.array("times", s.times, s.measurements.count);
    v.view("snr", s.snr);
    v.space("waveform_space", s.waveform_space);
    v.view("waveform", s.waveform);
}

/// The last of n + 1 offsets.
inline std::int64_t listed(const std::int64_t* offsets, std::int64_t n) noexcept {
    return offsets == nullptr ? 0 : offsets[n];
}

template <class Visitor> void visit_fields(Visitor& v, plr_tracks& t) {
    const std::int64_t parents = listed(t.parent_offsets, t.count), used = listed(t.measurement_offsets, t.count);
    v.number("count", t.count);
    v.text("frame", t.frame);
    v.space("space", t.space);
    v.array("ids", t.ids, t.count);
    v.array("times", t.times, t.count);
    v.array("status", t.status, t.count);
    v.array("misses", t.misses, t.count);
    v.view("mean", t.mean);
    v.view("covariance", t.covariance);
    v.view("extent", t.extent);
    v.array("parent_offsets", t.parent_offsets, t.count + 1);
    v.array("parents", t.parents, parents);
    v.array("groups", t.groups, t.count);
    v.array("measurement_offsets", t.measurement_offsets, t.count + 1);
    v.array("measurements", t.measurements, used);
    v.view("records", t.records);
    v.text("record_of", t.record_of);
    v.array("measurement_distances", t.measurement_distances, used);
    v.array("measurement_weights", t.measurement_weights, used);
}

template <class Visitor> void visit_fields(Visitor& v, plr_truth& t) {
    const std::int64_t measured = listed(t.measurement_offsets, t.count);
    v.number("count", t.count);
    v.text("frame", t.frame);
    v.space("space", t.space);
    v.array("ids", t.ids, t.count);
    v.array("times", t.times, t.count);
    v.view("state", t.state);
    v.view("extent", t.extent);
    v.array("parents", t.parents, t.count);
    v.array("births", t.births, t.count);
    v.array("measurement_offsets", t.measurement_offsets, t.count + 1);
    v.array("measurements", t.measurements, measured);
}

template <class Visitor> void visit_fields(Visitor& v, plr_quantity& q) {
    v.text("address", q.address);
    v.text("name", q.name);
    v.text("unit", q.unit);
    v.view("numbers", q.numbers);
    v.number("valid_from", q.valid_from);
    v.number("valid_to", q.valid_to);
    v.array("ids", q.ids, q.numbers.count);
}
template <class Visitor> void visit_fields(Visitor& v, plr_values& values) {
    v.elements("quantities", values.quantities, values.count);
}

template <class Visitor> void visit_fields(Visitor& v, plr_column& c) {
    v.number("reduce", c.reduce);
    v.text("name", c.name);
    v.text("unit", c.unit);
    v.number("quantile", c.quantile);
    v.texts("texts", c.texts, c.text_count);
}
template <class Visitor> void visit_fields(Visitor& v, plr_scalar& s) {
    v.number("reduce", s.reduce);
    v.text("name", s.name);
    v.text("unit", s.unit);
    v.number("value", s.value);
    v.number("quantile", s.quantile);
    v.text("column", s.column);
    v.number("weight", s.weight);
}
template <class Visitor> void visit_fields(Visitor& v, plr_table& t) {
    v.text("name", t.name);
    v.elements("columns", t.columns, t.column_count);
    v.view("rows", t.rows);
    v.elements("scalars", t.scalars, t.scalar_count);
}

/// The body of a message, by its kind: `visitor.body(const Body*&)`.
template <class Visitor> void visit_body(Visitor& visitor, plr_message& message) {
    switch (message.kind) {
        case PLR_MESSAGE_SCAN:
            return visitor.body(message.body.scan);
        case PLR_MESSAGE_TRACKS:
            return visitor.body(message.body.tracks);
        case PLR_MESSAGE_TRUTH:
            return visitor.body(message.body.truth);
        case PLR_MESSAGE_VALUES:
            return visitor.body(message.body.values);
        case PLR_MESSAGE_TABLE:
            return visitor.body(message.body.table);
        default:
            return;
    }
}

/// Element `index` of an array whose structs may be longer than we know.
template <class Element> const Element& element_of(const Element* first, std::uint32_t index) noexcept {
    const auto* at = reinterpret_cast<const unsigned char*>(first);
    return *reinterpret_cast<const Element*>(at + std::uint64_t{index} * first->struct_size);
}

}  // namespace pelorus::conformance

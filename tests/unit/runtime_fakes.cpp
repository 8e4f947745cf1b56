#include "runtime_fakes.hpp"

#include <cstring>
#include <stdexcept>

#include <fmt/format.h>

namespace fakes {
namespace {

/// A stage's table, and the C++ object behind it.
struct Adapter {
    static Stage& stage(void* self) { return *static_cast<Stage*>(self); }
    static plr_status next(void* self, const plr_call* call, plr_next* out) { return stage(self).next(*call, *out); }
    static plr_status emit(void* self, const plr_call* call) { return stage(self).emit(*call); }
    static plr_status receive(void* self, const plr_call* call, std::uint32_t port, const plr_message* message) {
        return stage(self).receive(*call, port, *message);
    }
    static plr_status finish(void* self, const plr_call* call) { return stage(self).finish(*call); }
    static plr_status save(const void* self, const plr_writer* writer, plr_error* error) {
        pelorus::runtime::ByteWriter bytes;
        static_cast<const Stage*>(self)->save(bytes);
        return writer->write(writer->context, bytes.bytes().data(), bytes.bytes().size(), error);
    }
    static plr_status load(void* self, const void* bytes, std::uint64_t size, plr_error* error) {
        try {
            pelorus::runtime::ByteReader reader(static_cast<const unsigned char*>(bytes), size);
            stage(self).load(reader);
            return PLR_OK;
        } catch (const std::exception& problem) {
            std::strncpy(error->message, problem.what(), sizeof error->message - 1);
            return error->code = PLR_E_DATA;
        }
    }
};

constexpr plr_stage table = {{sizeof(plr_stage), 0, nullptr, nullptr},
                             nullptr,
                             Adapter::next,
                             Adapter::emit,
                             Adapter::receive,
                             Adapter::finish,
                             Adapter::save,
                             Adapter::load};

double seconds(std::int64_t time) { return static_cast<double>(time) / second; }

plr_message header(std::uint32_t kind, std::int64_t time, std::int64_t arrival) {
    plr_message message{};
    message.struct_size = sizeof message;
    message.kind = kind;
    message.time = time;
    message.arrival = arrival;
    return message;
}

}  // namespace

plr_status Stage::publish(const plr_call& call, std::uint32_t port, const plr_message& message) const {
    return publisher->publish(publisher->context, port, &message, call.error);
}

plr_status fail(const plr_call& call, plr_status status, const char* message, const char* where, std::int64_t item) {
    if (call.error->code != PLR_OK) return status;
    call.error->code = status;
    call.error->item = item;
    std::strncpy(call.error->message, message, sizeof call.error->message - 1);
    std::strncpy(call.error->where, where, sizeof call.error->where - 1);
    return status;
}

plr_space position_space(std::uint32_t size) {
    static const plr_component components[3] = {{sizeof(plr_component), 0, "position.x", "m", 0, 1},
                                                {sizeof(plr_component), 0, "position.y", "m", 0, 1},
                                                {sizeof(plr_component), 0, "position.z", "m", 0, 1}};
    return {sizeof(plr_space), size, components};
}

plr_const_view view(const double* data, std::int64_t rows, std::int64_t cols, std::int64_t count) {
    return {data, rows, cols, count, 1, rows, rows * cols};
}

Scan::Scan(std::vector<double> given, std::string from)
    : sensor(std::move(from)), values(std::move(given)), variances(values.size(), 1.0), space(position_space()) {
    for (std::size_t i = 0; i < values.size(); ++i) ids.push_back(i);
    body.struct_size = sizeof body;
    body.sensor = sensor.c_str();
    body.frame = "";
    body.space = &space;
    body.measurements = view(values.data(), 1, 1, static_cast<std::int64_t>(values.size()));
    body.covariances = view(variances.data(), 1, 1, static_cast<std::int64_t>(values.size()));
    body.ids = ids.data();
}

plr_message Scan::message(std::int64_t time, std::int64_t arrival) const {
    plr_message out = header(PLR_MESSAGE_SCAN, time, arrival);
    out.body.scan = &body;
    return out;
}

Command::Command(double value) : number(value) {
    quantity = {sizeof quantity, 0, "radar", "value", "m", view(&number, 1, 1, 1), INT64_MIN, INT64_MAX, nullptr};
    body = {sizeof body, 1, &quantity};
}

plr_message Command::message(std::int64_t time) const {
    plr_message out = header(PLR_MESSAGE_VALUES, time, INT64_MIN);
    out.body.values = &body;
    return out;
}

Table::Table(const char* name, std::vector<double> given) : rows(std::move(given)) {
    columns[0] = {sizeof(plr_column), PLR_REDUCE_KEY, "time", "s", 0, nullptr, 0, 0};
    columns[1] = {sizeof(plr_column), PLR_REDUCE_ROOT_MEAN_SQUARE, "error", "m", 0, nullptr, 0, 0};
    scalar = {sizeof scalar, 0, "rmse", "m", 0, 0, "error", 0};
    body.struct_size = sizeof body;
    body.name = name;
    body.column_count = 2;
    body.columns = columns;
    body.rows = view(rows.data(), 2, 1, static_cast<std::int64_t>(rows.size() / 2));
    body.scalars = &scalar;
    body.scalar_count = 1;
}

plr_message Table::message(std::int64_t time) const {
    plr_message out = header(PLR_MESSAGE_TABLE, time, INT64_MIN);
    out.body.table = &body;
    return out;
}

void Graph::add(const std::string& name, const std::string& kind, std::shared_ptr<Stage> stage, std::vector<PortOf> in,
                std::vector<PortOf> out) {
    hosts_.push_back(
        std::make_unique<pelorus::host::InstanceHost>(name, kind + ".fake", pelorus::host::InstanceHost::Shared{}));
    const plr_host* host = hosts_.back()->host();
    stage->publisher = static_cast<const plr_publish*>(host->service(host, PLR_SERVICE_PUBLISH));

    std::vector<plr_port> ports;
    for (const auto* side : {&in, &out})
        for (const PortOf& port : *side) ports.push_back({sizeof(plr_port), 0, port.name, "", port.message, 0});
    const std::string id = kind + ".fake";
    plr_description description{};
    description.struct_size = sizeof description;
    description.id = id.c_str();
    description.kind = kind.c_str();
    description.version = version.c_str();
    description.in_ports = ports.data();
    description.in_port_count = static_cast<std::uint32_t>(in.size());
    description.out_ports = ports.data() + in.size();
    description.out_port_count = static_cast<std::uint32_t>(out.size());
    wiring_.nodes.push_back(
        pelorus::runtime::wire_node(name, description, {stage.get(), &table.head}, hosts_.back().get()));
    wiring_.order.push_back(wiring_.order.size());
    stages_.push_back(std::move(stage));
}

std::size_t Graph::index(const std::string& name) const {
    for (std::size_t i = 0; i < wiring_.nodes.size(); ++i)
        if (wiring_.nodes[i].name == name) return i;
    throw std::out_of_range(name);
}

pelorus::host::InstanceHost& Graph::host(const std::string& name) { return *hosts_.at(index(name)); }

void Graph::connect(const std::string& from, const std::string& to, bool previous) {
    const auto find = [&](const std::string& end, bool out) {
        const std::size_t dot = end.find('.'), node = index(end.substr(0, dot));
        const auto& ports = out ? wiring_.nodes[node].out_ports : wiring_.nodes[node].in_ports;
        for (std::size_t i = 0; i < ports.size(); ++i)
            if (ports[i].name == end.substr(dot + 1)) return std::make_pair(node, i);
        throw std::out_of_range(end);
    };
    const auto [from_node, from_port] = find(from, true);
    const auto [to_node, to_port] = find(to, false);
    wiring_.edges.push_back({from_node, from_port, to_node, to_port, previous, {}});
}

plr_status Ticker::next(const plr_call&, plr_next& out) {
    out.what = done_ < count_ ? PLR_NEXT_DATA : PLR_NEXT_END;
    out.arrival = first_ + done_ * period_;
    out.time = out.arrival - delay_;
    return PLR_OK;
}

plr_status Ticker::emit(const plr_call& call) {
    const Scan scan({commanded_ ? command_ : static_cast<double>(done_)}, sensor_);
    ++done_;
    return publish(call, 0, scan.message(call.time - delay_));
}

plr_status Ticker::receive(const plr_call& call, std::uint32_t, const plr_message& message) {
    command_ = first_number(message);
    commanded_ = true;
    commands.push_back(fmt::format("{} of {} at {}", command_, seconds(message.arrival), seconds(call.time)));
    return PLR_OK;
}

void Ticker::save(pelorus::runtime::ByteWriter& writer) const {
    writer.number(done_);
    writer.number(command_);
    writer.number(static_cast<std::uint8_t>(commanded_));
}

void Ticker::load(pelorus::runtime::ByteReader& reader) {
    const int done = reader.number<int>();
    const auto command = reader.number<double>();
    commanded_ = reader.flag();
    done_ = done;
    command_ = command;
}

plr_status Recorder::receive(const plr_call& call, std::uint32_t port, const plr_message& message) {
    const double number = first_number(message);
    log_->push_back(
        fmt::format("{} {} {} {} {}", name_, port, seconds(message.time), seconds(message.arrival), number));
    sum += number;
    return reaction_ ? reaction_(*this, call, port, message) : PLR_OK;
}

plr_status Recorder::finish(const plr_call& call) {
    finished = true;
    log_->push_back(name_ + " finish");
    return at_finish ? at_finish(*this, call) : PLR_OK;
}

void Recorder::save(pelorus::runtime::ByteWriter& writer) const { writer.number(sum); }
void Recorder::load(pelorus::runtime::ByteReader& reader) { sum = reader.number<double>(); }

double first_number(const plr_message& message) {
    switch (message.kind) {
        case PLR_MESSAGE_SCAN:
            return message.body.scan->measurements.count > 0 ? message.body.scan->measurements.data[0] : -1;
        case PLR_MESSAGE_VALUES:
            return message.body.values->quantities[0].numbers.data[0];
        case PLR_MESSAGE_TABLE:
            return message.body.table->rows.count > 0 ? message.body.table->rows.data[0] : -1;
        default:
            return 0;
    }
}

}  // namespace fakes

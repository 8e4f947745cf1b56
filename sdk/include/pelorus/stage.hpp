/// Stages in C++: nodes of the dataflow graph.
///
///     struct Mine : pelorus::Stage<Mine> {
///         static constexpr const char* kind = "tracker";
///         static void describe(pelorus::Describe<Mine>& plugin);            // in_port, out_port, slot, parameter, ...
///         void on_scan(const Event& event, const plr_scan& scan);           // one for each kind of message that comes in
///         void finish(const Event& event);                                  // optional
///         template <class Archive> void state(Archive& archive);            // optional: what save and load keep
///     };
///
/// on_scan, on_tracks, on_truth, on_values, on_table: those that exist are called, `event.port` says through which port.
/// Sources have instead `plr_next next()` and `void emit(const Event&)`.
/// Optional: `std::vector<Stream> in_streams(std::uint32_t port) const`, `out_streams`: what the ports carry; asked once, after
/// setup; `std::uint32_t passes_on(std::uint32_t port) const`: 1 + the in port whose streams an out port passes on. Publishing: `publish(port, message)` from within a call.
/// All calls are [worker, exclusive].
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include <pelorus/abi/stage.h>
#include <pelorus/archive.hpp>
#include <pelorus/messages.hpp>
#include <pelorus/plugin.hpp>

namespace pelorus {

/// One stream through a port (see plr_stream).
struct Stream {
    std::string sensor;
    bool any_sensor = false;
    Space space;
    bool any_space = false;
    std::string frame;
    bool any_frame = false;
    bool at_least = false;  ///< in ports: further components are welcome
};

/// What comes with a call of a stage.
struct Event {
    std::int64_t arrival = 0;  ///< ns
    std::int64_t time = 0;     ///< ns; the message's stamp (arrival in emit and finish)
    std::uint32_t port = 0;
    const plr_call* call = nullptr;
};

namespace detail {

#define PELORUS_DETECT(name)                                                                                       \
    template <class T, class Body, class = void> struct has_##name : std::false_type {};                           \
    template <class T, class Body>                                                                                 \
    struct has_##name<                                                                                             \
        T, Body,                                                                                                   \
        std::void_t<decltype(std::declval<T&>().name(std::declval<const Event&>(), std::declval<const Body&>()))>> \
        : std::true_type {}
PELORUS_DETECT(on_scan);
PELORUS_DETECT(on_tracks);
PELORUS_DETECT(on_truth);
PELORUS_DETECT(on_values);
PELORUS_DETECT(on_table);
#undef PELORUS_DETECT

template <class T, class = void> struct has_finish : std::false_type {};
template <class T>
struct has_finish<T, std::void_t<decltype(std::declval<T&>().finish(std::declval<const Event&>()))>> : std::true_type {
};
template <class T, class = void> struct has_emit : std::false_type {};
template <class T>
struct has_emit<T, std::void_t<decltype(std::declval<T&>().emit(std::declval<const Event&>()))>> : std::true_type {};
template <class T, class = void> struct has_state : std::false_type {};
template <class T>
struct has_state<T, std::void_t<decltype(std::declval<T&>().state(std::declval<StateWriter&>()))>> : std::true_type {};
template <class T, class = void> struct has_in_streams : std::false_type {};
template <class T>
struct has_in_streams<T, std::void_t<decltype(std::declval<const T&>().in_streams(0u))>> : std::true_type {};
template <class T, class = void> struct has_out_streams : std::false_type {};
template <class T>
struct has_out_streams<T, std::void_t<decltype(std::declval<const T&>().out_streams(0u))>> : std::true_type {};

template <class T, class = void> struct has_passes_on : std::false_type {};
template <class T>
struct has_passes_on<T, std::void_t<decltype(std::declval<const T&>().passes_on(0u))>> : std::true_type {};

/// FNV-1a, 64 bits: guards saved state against truncation and chance, not against malice.
inline std::uint64_t fingerprint(const unsigned char* bytes, std::size_t size) noexcept {
    std::uint64_t hash = 14695981039346656037u;
    for (std::size_t i = 0; i < size; ++i) hash = (hash ^ bytes[i]) * 1099511628211u;
    return hash;
}

}  // namespace detail

template <class Derived> class Stage {
public:
    static constexpr const char* table_id = PLR_STAGE;
    static constexpr const char* version = "1.0.0";
    static constexpr std::uint32_t state_version = 1;

    const void* extension(const char*) const noexcept { return nullptr; }

    void complete(const plr_config& config, const plr_description& description) {
        publish_ = Setup(config).optional_service<plr_publish>();
        if constexpr (detail::has_in_streams<Derived>::value)
            for (std::uint32_t p = 0; p < description.in_port_count; ++p) in_.emplace_back(derived().in_streams(p));
        if constexpr (detail::has_out_streams<Derived>::value)
            for (std::uint32_t p = 0; p < description.out_port_count; ++p) out_.emplace_back(derived().out_streams(p));
    }

    static const plr_stage& table() noexcept {
        constexpr bool source = detail::has_emit<Derived>::value, saves = detail::has_state<Derived>::value;
        static constexpr plr_stage t{{sizeof(plr_stage), 0, &detail::destroy<Derived>, &extension_entry},
                                     &port_type_entry,
                                     source ? &next_entry : nullptr,
                                     source ? &emit_entry : nullptr,
                                     &receive_entry,
                                     &finish_entry,
                                     saves ? &save_entry : nullptr,
                                     saves ? &load_entry : nullptr};
        return t;
    }

protected:
    Derived& derived() noexcept { return static_cast<Derived&>(*this); }
    const Derived& derived() const noexcept { return static_cast<const Derived&>(*this); }

    /// Sends a message through an out port (index in the order of declaration).
    void publish(std::uint32_t port, const plr_message& message) {
        if (publish_ == nullptr) throw UnsupportedError("this host has no service " PLR_SERVICE_PUBLISH);
        plr_error error{};
        error.struct_size = sizeof error;
        const plr_status status = publish_->publish(publish_->context, port, &message, &error);
        if (status != PLR_OK) throw Failure(status, error.message, error.where);
    }

private:
    /// The streams of one port, kept in the shape the ABI wants.
    class PortStreams {
    public:
        explicit PortStreams(std::vector<Stream> streams) : streams_(std::move(streams)) {
            for (const Stream& s : streams_)
                raw_.push_back({sizeof(plr_stream), s.at_least ? std::uint32_t{PLR_STREAM_AT_LEAST} : 0u,
                                s.any_sensor ? nullptr : s.sensor.c_str(), s.any_space ? nullptr : s.space.c(),
                                s.any_frame ? nullptr : s.frame.c_str()});
        }
        plr_port_type type() const noexcept {
            return {sizeof(plr_port_type), static_cast<std::uint32_t>(raw_.size()), raw_.data(), 0, 0};
        }

    private:
        std::vector<Stream> streams_;
        std::vector<plr_stream> raw_;
    };

    static Derived& self_of(void* self) noexcept { return *static_cast<Derived*>(self); }
    static const Derived& self_of(const void* self) noexcept { return *static_cast<const Derived*>(self); }
    static const void* extension_entry(const void* self, const char* id) noexcept {
        return self_of(self).extension(id);
    }

    static plr_status port_type_entry(const void* self, std::uint32_t is_output, std::uint32_t port, plr_port_type* out,
                                      plr_error*) noexcept {
        const auto& ports = is_output != 0 ? self_of(self).out_ : self_of(self).in_;
        *out = {sizeof(plr_port_type), 0, nullptr, 0, 0};
        if (port < ports.size()) *out = ports[port].type();
        if constexpr (detail::has_passes_on<Derived>::value)
            if (is_output != 0) out->passes_on = self_of(self).passes_on(port);
        return PLR_OK;
    }
    static plr_status next_entry(void* self, const plr_call* call, plr_next* out) noexcept {
        return guarded(call->error, [&] {
            if constexpr (detail::has_emit<Derived>::value) *out = self_of(self).next();
        });
    }
    static plr_status emit_entry(void* self, const plr_call* call) noexcept {
        return guarded(call->error, [&] {
            if constexpr (detail::has_emit<Derived>::value) self_of(self).emit(Event{call->time, call->time, 0, call});
        });
    }
    static plr_status receive_entry(void* self, const plr_call* call, std::uint32_t port,
                                    const plr_message* message) noexcept {
        return guarded(call->error, [&] {
            Derived& stage = self_of(self);
            const Event event{call->time, message->time, port, call};
            switch (message->kind) {
                case PLR_MESSAGE_SCAN:
                    if constexpr (detail::has_on_scan<Derived, plr_scan>::value)
                        return stage.on_scan(event, *message->body.scan);
                    break;
                case PLR_MESSAGE_TRACKS:
                    if constexpr (detail::has_on_tracks<Derived, plr_tracks>::value)
                        return stage.on_tracks(event, *message->body.tracks);
                    break;
                case PLR_MESSAGE_TRUTH:
                    if constexpr (detail::has_on_truth<Derived, plr_truth>::value)
                        return stage.on_truth(event, *message->body.truth);
                    break;
                case PLR_MESSAGE_VALUES:
                    if constexpr (detail::has_on_values<Derived, plr_values>::value)
                        return stage.on_values(event, *message->body.values);
                    break;
                case PLR_MESSAGE_TABLE:
                    if constexpr (detail::has_on_table<Derived, plr_table>::value)
                        return stage.on_table(event, *message->body.table);
                    break;
                default:
                    break;
            }
            throw ArgumentError("a message of a kind that this stage does not take came in at port " +
                                std::to_string(port));
        });
    }
    static plr_status finish_entry(void* self, const plr_call* call) noexcept {
        return guarded(call->error, [&] {
            if constexpr (detail::has_finish<Derived>::value)
                self_of(self).finish(Event{call->time, call->time, 0, call});
        });
    }

    // Saved state: "PLRSTATE", version, fingerprint of the body, body.
    struct StateHead {
        char magic[8];
        std::uint64_t version, fingerprint;
    };
    static plr_status save_entry(const void* self, const plr_writer* writer, plr_error* error) noexcept {
        return guarded(error, [&]() -> plr_status {
            if constexpr (detail::has_state<Derived>::value) {
                // `state` serves both ways and so cannot be const; writing changes nothing.
                const std::vector<unsigned char> body = written(const_cast<Derived&>(self_of(self)));
                StateHead head{{'P', 'L', 'R', 'S', 'T', 'A', 'T', 'E'},
                               Derived::state_version,
                               detail::fingerprint(body.data(), body.size())};
                const plr_status status = writer->write(writer->context, &head, sizeof head, error);
                return status != PLR_OK ? status : writer->write(writer->context, body.data(), body.size(), error);
            }
            return PLR_OK;
        });
    }
    static plr_status load_entry(void* self, const void* bytes, std::uint64_t size, plr_error* error) noexcept {
        return guarded(error, [&] {
            if constexpr (detail::has_state<Derived>::value) {
                StateHead head{};
                if (size < sizeof head) throw DataError("saved state is truncated");
                std::memcpy(&head, bytes, sizeof head);
                const unsigned char* body = static_cast<const unsigned char*>(bytes) + sizeof head;
                const auto body_size = static_cast<std::size_t>(size - sizeof head);
                if (std::memcmp(head.magic, "PLRSTATE", 8) != 0) throw DataError("is not saved state");
                if (head.version != Derived::state_version)
                    throw Failure(PLR_E_STATE_VERSION, "saved state has version " + std::to_string(head.version) +
                                                           ", this plugin reads " +
                                                           std::to_string(Derived::state_version));
                if (head.fingerprint != detail::fingerprint(body, body_size)) throw DataError("saved state is corrupt");
                take_over(self_of(self), body, body_size);
            }
        });
    }
    static std::vector<unsigned char> written(Derived& stage) {
        StateWriter writer;
        stage.state(writer);
        return writer.bytes();
    }
    /// Whole or not at all: what was there comes back if the new state cannot be read to its end.
    static void take_over(Derived& stage, const unsigned char* body, std::size_t size) {
        const std::vector<unsigned char> before = written(stage);
        try {
            StateReader reader(body, size);
            stage.state(reader);
            if (reader.left() != 0) throw DataError("saved state is longer than expected");
        } catch (...) {
            StateReader reader(before.data(), before.size());
            stage.state(reader);
            throw;
        }
    }

    const plr_publish* publish_ = nullptr;
    std::vector<PortStreams> in_, out_;
};

}  // namespace pelorus

/* Pelorus in an application: the C functions of libpelorus.
 *
 * A pipeline is a config, checked and wired, that the application moves on: it pushes messages (scans) into nodes
 * `source.external`, lets the graph handle them, and pulls what other nodes publish (tracks). Messages are those of the plugin
 * ABI (<pelorus/abi/message.h>). <pelorus/embed.hpp> is the same in C++. docs/embedding.md is the guide.
 *
 * Threads: [any] may be called by any thread at any time. [exclusive] by any thread, but one at a time for each pipeline (and what
 * belongs to it); a second one is refused, not blocked. Different pipelines know nothing of each other. From within a
 * callback of this library, nothing of it may be called but pelorus_stop and the functions that tell versions.
 *
 * Errors: a function answers PLR_OK or what went wrong: a plr_status (<pelorus/abi/status.h>) or one of PELORUS_E_...
 * `error` may be NULL; otherwise the caller sets its struct_size, and every call overwrites it: code, item, one line. The whole text,
 * which has several lines where a config is refused, is pelorus_error_text(). No exception leaves. A refused call changes nothing; where
 * a plugin fails in the middle of the run, the pipeline answers PELORUS_E_BROKEN from then on, and what was published can still be
 * pulled and read.
 *
 * Structs that begin with struct_size grow at the tail: the caller sets it to sizeof, also of those that are answered.
 */
#ifndef PELORUS_EMBED_H
#define PELORUS_EMBED_H

#include <pelorus/abi/log.h>
#include <pelorus/abi/message.h>
#include <pelorus/abi/stage.h>
#include <pelorus/abi/status.h>

#define PELORUS_API __attribute__((visibility("default")))

/* Of these headers. A library of the same major and of this minor or a later one serves; while the major is 0, the minor must be the
 * same. */
#define PELORUS_API_MAJOR 0
#define PELORUS_API_MINOR 1

PLR_EXTERN_C_BEGIN

typedef struct pelorus_pipeline pelorus_pipeline;
typedef struct pelorus_subscription pelorus_subscription;

enum {
    PELORUS_E_CONFIG = -100,    /* the config, an option or a plugin that it needs is wrong */
    PELORUS_E_NOT_FOUND = -101, /* there is no such node, port, scalar */
    PELORUS_E_LATE = -102,   /* the message arrives before an event that was handled (and its node says late: refuse) */
    PELORUS_E_FULL = -103,   /* a queue is full: pull, then call again; nothing is lost */
    PELORUS_E_FAILED = -104, /* the run failed in this call; the pipeline is broken */
    PELORUS_E_BROKEN = -105, /* it failed in an earlier one */
    PELORUS_E_FINISHED = -106, /* the pipeline was finished */
    PELORUS_E_BUSY = -107      /* another thread is within a call of this pipeline */
};

/* ---- Versions ---- */

/* [any] major * 65536 + minor of the library that is loaded. */
PELORUS_API uint32_t pelorus_api_version(void);
/* [any] Of the library, for people: "0.1.0". */
PELORUS_API const char* pelorus_version(void);
/* [any] The id of its messages, see PLR_MESSAGES. */
PELORUS_API const char* pelorus_messages_id(void);
/* [any] Whether the library that is loaded serves an application compiled with these headers: 1 or 0. */
PELORUS_API int32_t pelorus_serves(uint32_t api_major, uint32_t api_minor, const char* messages_id);
static inline int32_t pelorus_is_compatible(void) {
    return pelorus_serves(PELORUS_API_MAJOR, PELORUS_API_MINOR, PLR_MESSAGES);
}

/* ---- Errors and log ---- */

/* [any] All that the last failed call on this thread had to say, lines separated by \n, or "". Valid until the next
 * call of a function of this library on this thread that takes an `error`. */
PELORUS_API const char* pelorus_error_text(void);

/* One line of the log of level PLR_LOG_...; `name` is the writer's: `tracker (tracker.point_target)`. Any thread, one at a time. */
typedef void (*pelorus_log_function)(void* context, int32_t level, const char* name, const char* line);

/* [any] Where the log of the whole process goes; `write` NULL: to standard error, as from the start. The level is that of
 * pipelines opened from now on. After this has returned, the former function is not called any more. */
PELORUS_API plr_status pelorus_set_log(int32_t level, pelorus_log_function write, void* context, plr_error* error);

/* ---- Opening and closing ---- */

typedef struct pelorus_setting {
    const char* name;
    const char* value;
} pelorus_setting;

/* Zeros are the defaults. */
typedef struct pelorus_options {
    uint32_t struct_size;
    uint32_t threads;                  /* that plugins share; 0: one; PELORUS_ALL_CORES: one a core. Same results */
    const char* const* plugin_folders; /* [plugin_folder_count] looked through first, in this order */
    const pelorus_setting* overrides;  /* [override_count] address and value: {"radar.noise", "5 m"} */
    const pelorus_setting* variables;  /* [variable_count] that path parameters may name, before the environment's */
    uint32_t plugin_folder_count;
    uint32_t override_count;
    uint32_t variable_count;
    uint32_t reserved;
    const uint64_t* seed; /* or NULL: the config's */
    /* What sinks write, and summary.json at the end; NULL: none, and sinks of files then fail. */
    const char* result_folder;
} pelorus_options;

#define PELORUS_ALL_CORES UINT32_MAX

/* [any] Reads a config file, checks all of it, makes all instances, joins them. `options` may be NULL. On failure *out is NULL:
 * PELORUS_E_CONFIG with all that is wrong, a line each, in pelorus_error_text(); PELORUS_E_FAILED: the system refused something. */
PELORUS_API plr_status pelorus_open(const char* file, const pelorus_options* options, pelorus_pipeline** out,
                                    plr_error* error);
/* [any] The same from a text. `name` stands for the file in messages, `base` is the folder that its paths are relative to. */
PELORUS_API plr_status pelorus_open_text(const char* text, const char* name, const char* base,
                                         const pelorus_options* options, pelorus_pipeline** out, plr_error* error);
/* [any] Ends the pipeline and its subscriptions, whose handles are gone with it. A call that is under way on another thread is ended as by
 * pelorus_stop and waited for; none may begin any more. It does not finish the pipeline: files of sinks that were not finished stay
 * incomplete. NULL: nothing happens. */
PELORUS_API void pelorus_close(pelorus_pipeline* pipeline);

/* ---- The graph ---- */

typedef struct pelorus_node_info {
    uint32_t struct_size;
    uint32_t reserved;
    const char* name;
    const char* kind;   /* `tracker` */
    const char* plugin; /* its id */
    const char* version;
} pelorus_node_info;

typedef struct pelorus_port_info {
    uint32_t struct_size;
    uint32_t message; /* PLR_MESSAGE_... */
    const char* node;
    const char* port;
    uint32_t is_output;
    uint32_t can_push;     /* messages may be pushed into it */
    uint32_t stream_count; /* 0: it does not say, and everything goes */
    uint32_t reserved;
    const plr_stream* streams; /* [stream_count] sensor, space with units, frame of what it carries */
} pelorus_port_info;

/* [exclusive] Nodes in file order; what is answered lives as long as the pipeline. PELORUS_E_NOT_FOUND: index is too high. */
PELORUS_API plr_status pelorus_node(pelorus_pipeline* pipeline, uint32_t index, pelorus_node_info* out,
                                    plr_error* error);
/* [exclusive] Ports of all nodes in file order, in ports first; likewise. */
PELORUS_API plr_status pelorus_port(pelorus_pipeline* pipeline, uint32_t index, pelorus_port_info* out,
                                    plr_error* error);

/* ---- Moving on ---- */

/* [exclusive] Puts a message into an in port of a `source.external`: "radar.scans". It is copied. What comes before it (by arrival,
 * time, order of the nodes) is handled first; what it brings about waits for the next call, because other messages of the same
 * arrival may still be pushed. message.arrival INT64_MIN: its time. Spaces, sensor, frame and shapes are checked: PLR_E_ARGUMENT;
 * PELORUS_E_LATE; PELORUS_E_FULL and PLR_E_CANCELLED: it was not pushed. A late one that the node's config says to drop answers PLR_OK. */
PELORUS_API plr_status pelorus_push(pelorus_pipeline* pipeline, const char* port, const plr_message* message,
                                    plr_error* error);
/* [exclusive] Handles all that arrives up to `until` (ns). Does not wait for live sources. PELORUS_E_FULL, PLR_E_CANCELLED: some of it;
 * the next call goes on. */
PELORUS_API plr_status pelorus_advance(pelorus_pipeline* pipeline, int64_t until, plr_error* error);
/* [exclusive] Handles all until every source of the graph has ended and nothing waits; waits for live sources. Likewise. */
PELORUS_API plr_status pelorus_play(pelorus_pipeline* pipeline, plr_error* error);
/* [any] Ends the call that is under way (or the next one) between two events with PLR_E_CANCELLED; the one after it goes on. */
PELORUS_API void pelorus_stop(pelorus_pipeline* pipeline);
/* [exclusive] No more will come: handles what waits, lets all stages finish, completes files, writes the result folder. After
 * it messages can be pulled and results read, nothing else. */
PELORUS_API plr_status pelorus_finish(pelorus_pipeline* pipeline, plr_error* error);
/* [exclusive] The arrival of the event handled last, ns; INT64_MIN: none yet. */
PELORUS_API plr_status pelorus_now(pelorus_pipeline* pipeline, int64_t* out, plr_error* error);

/* ---- Messages that come out ---- */

enum {
    PELORUS_WHEN_FULL_REFUSE =
        0, /* push, advance and play stop before the next event with PELORUS_E_FULL until there is room */
    PELORUS_WHEN_FULL_DROP_OLDEST = 1 /* the oldest makes room; counted */
};

typedef struct pelorus_subscription_options {
    uint32_t struct_size;
    uint32_t when_full;
    uint64_t capacity; /* messages; 0: 1024. With REFUSE, what one event (or finish) publishes may go beyond it */
} pelorus_subscription_options;

typedef struct pelorus_subscription_info {
    uint32_t struct_size;
    uint32_t reserved;
    uint64_t waiting; /* messages to be pulled */
    uint64_t dropped; /* so far */
} pelorus_subscription_info;

/* [exclusive] Keeps from now on what an out port publishes, in that order: "tracker.tracks". `options` may be NULL. The subscription belongs
 * to the pipeline; several of one port are independent. */
PELORUS_API plr_status pelorus_subscribe(pelorus_pipeline* pipeline, const char* port,
                                         const pelorus_subscription_options* options, pelorus_subscription** out,
                                         plr_error* error);
/* [exclusive] The oldest message that waits, or NULL in *out if none does. Borrowed until the next pull of this subscription. */
PELORUS_API plr_status pelorus_pull(pelorus_subscription* subscription, const plr_message** out, plr_error* error);
/* [exclusive] */
PELORUS_API plr_status pelorus_subscription_state(pelorus_subscription* subscription, pelorus_subscription_info* out,
                                                  plr_error* error);
/* [exclusive] Ends it before the pipeline. NULL: nothing happens. */
PELORUS_API void pelorus_unsubscribe(pelorus_subscription* subscription);

/* ---- Results so far ---- */

typedef struct pelorus_scalar_info {
    uint32_t struct_size;
    uint32_t reserved;
    const char* name; /* `errors.position_rmse` */
    const char* unit;
    double value;
} pelorus_scalar_info;

typedef struct pelorus_diagnostic_info {
    uint32_t struct_size;
    uint32_t is_counter; /* or a gauge */
    const char* node;
    const char* name; /* `refused`, `late_dropped`, whatever the plugin counts */
    const char* unit; /* of a gauge */
    int64_t count;    /* of a counter */
    double value;     /* of a gauge */
} pelorus_diagnostic_info;

/* [exclusive] What analyzers have told so far, as summary.json has it; after a failure, too. What is answered is borrowed until
 * the next push, advance, play, finish or restore. PELORUS_E_NOT_FOUND: index is too high, or no such name. */
PELORUS_API plr_status pelorus_scalar(pelorus_pipeline* pipeline, uint32_t index, pelorus_scalar_info* out,
                                      plr_error* error);
PELORUS_API plr_status pelorus_find_scalar(pelorus_pipeline* pipeline, const char* name, pelorus_scalar_info* out,
                                           plr_error* error);
/* [exclusive] Likewise; table.name is `errors.by_time`, and it has no scalars. */
PELORUS_API plr_status pelorus_table(pelorus_pipeline* pipeline, uint32_t index, const plr_table** out,
                                     plr_error* error);
/* [exclusive] Counters and gauges of all nodes; likewise. */
PELORUS_API plr_status pelorus_diagnostic(pelorus_pipeline* pipeline, uint32_t index, pelorus_diagnostic_info* out,
                                          plr_error* error);

/* ---- Snapshots ---- */

/* [exclusive] Writes the state of the whole graph, messages under way included, in pieces to `writer`. Messages that wait in
 * subscriptions are not part of it: they have left the graph. PLR_E_UNSUPPORTED: a node cannot tell its state; the pipeline goes on. */
PELORUS_API plr_status pelorus_snapshot(pelorus_pipeline* pipeline, const plr_writer* writer, plr_error* error);
/* [exclusive] Takes a snapshot of the same config over, into a pipeline that has not begun. PLR_E_DATA: it is damaged, or of another
 * config, seed or plugin; nothing has changed then. Where a plugin refuses its own part, the line says so, and the pipeline is broken. */
PELORUS_API plr_status pelorus_restore(pelorus_pipeline* pipeline, const void* bytes, uint64_t size, plr_error* error);

PLR_EXTERN_C_END

#endif

/* Pelorus ABI: how a plugin describes itself. All of it is constant data of the library.
 *
 * The host checks configs, prints help, and makes JSON Schema and reference pages from this; a plugin never parses text.
 */
#ifndef PELORUS_ABI_DESCRIBE_H
#define PELORUS_ABI_DESCRIBE_H

#include "view.h"

enum {
  PLR_TYPE_BOOL = 1,   /* value.integer 0 or 1 */
  PLR_TYPE_INT = 2,    /* value.integer */
  PLR_TYPE_DOUBLE = 3, /* value.number, SI */
  PLR_TYPE_STRING = 4, /* value.text */
  PLR_TYPE_CHOICE = 5, /* value.integer = index into choices, value.text = the word */
  PLR_TYPE_PATH = 6,   /* value.text, absolute; ${VARIABLES} expanded */
  PLR_TYPE_VECTOR = 7, /* value.numbers rows x 1, SI; a scalar in the config fills all rows */
  PLR_TYPE_MATRIX = 8, /* value.numbers rows x cols */
  PLR_TYPE_TABLE = 9   /* value.numbers rows x columns (text columns: 0) and value.texts */
};

enum {
  PLR_PARAMETER_REQUIRED = 1u << 0,      /* no default */
  PLR_PARAMETER_OPTIONAL = 1u << 1,      /* no default; value.present says whether it was given */
  PLR_PARAMETER_MIN_EXCLUSIVE = 1u << 2, /* min itself is refused */
  PLR_PARAMETER_MAX_EXCLUSIVE = 1u << 3
};

/* A parameter, or a column of a table parameter. */
typedef struct plr_parameter {
  uint32_t struct_size;
  uint32_t type;
  uint32_t flags;
  uint32_t choice_count;
  const char* name;
  const char* doc;  /* one sentence */
  const char* unit; /* SI; "" for pure numbers; vectors and matrices: one for all elements, or "m, rad, rad" a row */
  const char* default_text;       /* as one would write it in a config: "0.1 1/s", "[0 m, 0 m, 0 m]", "true" */
  double min, max;                /* SI, each element; -INFINITY, INFINITY: none */
  const char* const* choices;     /* [choice_count] */
  const char* const* choice_docs; /* [choice_count] or NULL */
  int32_t rows_min, rows_max;     /* length of a vector, rows of a matrix or table; rows_max -1: any */
  int32_t cols_min, cols_max;     /* matrices only */
  uint32_t column_count;          /* tables only */
  uint32_t reserved;
  const struct plr_parameter* columns; /* [column_count] bool, int, double, string, choice */
} plr_parameter;

/* A parameter's value, parsed, converted and checked, in the order of the description. */
typedef struct plr_value {
  uint32_t struct_size;
  uint32_t present; /* 0: an optional parameter that was not given */
  int64_t integer;
  double number;
  const char* text;
  plr_const_view numbers;
  const char* const* texts; /* tables: [rows * columns], row by row; NULL for numeric columns */
} plr_value;

/* Something that a model reads in each call and that nobody knows when it is created: a plane's normal, a bias, a pose. */
typedef struct plr_input {
  uint32_t struct_size;
  uint32_t size; /* doubles */
  const char* name;
  const char* unit; /* one for all, or "m, rad, rad" */
  const char* doc;
  const double* defaults; /* [size] */
} plr_input;

/* A place for other plugins. */
typedef struct plr_slot {
  uint32_t struct_size;
  int32_t min, max; /* how many parts; max -1: any number. max 1: an unnamed part may stand there */
  uint32_t parameter_count;
  const char* name;
  const char* kind;
  const char* doc;
  const plr_parameter* parameters; /* what the holder wants to know of each part, written in the part's own `with` */
} plr_slot;

enum { PLR_PORT_OPTIONAL = 1u << 0, PLR_PORT_MANY = 1u << 1 /* several edges may end here */ };

typedef struct plr_port {
  uint32_t struct_size;
  uint32_t flags;
  const char* name;
  const char* doc;
  uint32_t message; /* PLR_MESSAGE_..., see message.h */
  uint32_t reserved;
} plr_port;

enum {
  PLR_DESCRIPTION_OVERLAP = 1u << 0 /* partitioner: a measurement may be in several cells of one alternative */
};

typedef struct plr_description {
  uint32_t struct_size;
  uint32_t flags;
  const char* id;       /* `motion.singer`; third parties `org.example.motion.mine` */
  const char* kind;     /* `motion` */
  const char* version;  /* of the plugin, semantic */
  const char* title;    /* a few words */
  const char* purpose;  /* a paragraph */
  const char* equation; /* plain text; "" where there is none */
  const char* source;   /* authors, title, year, equation; "" where there is none */
  const char* license;  /* SPDX */
  const plr_parameter* parameters;
  const plr_input* inputs;
  const plr_slot* slots;
  const plr_port* in_ports;  /* stages */
  const plr_port* out_ports; /* stages */
  uint32_t parameter_count, input_count, slot_count, in_port_count, out_port_count;
  uint32_t reserved;
} plr_description;

#endif

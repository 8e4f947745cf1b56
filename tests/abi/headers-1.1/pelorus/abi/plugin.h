/* Pelorus ABI: what a plugin is once it is loaded: a description, and a way to make instances.
 *
 * An instance comes with its own call table: a plugin that is compiled for several dimensions answers with the table
 * that fits. Which struct the table is says `table_id` (PLR_MOTION, PLR_SENSOR, ...). All tables of models and stages
 * begin with plr_table_head.
 */
#ifndef PELORUS_ABI_PLUGIN_H
#define PELORUS_ABI_PLUGIN_H

#include "call.h"
#include "describe.h"
#include "host.h"
#include "space.h"

typedef struct plr_table_head {
  uint32_t struct_size; /* of the whole table: optional functions at the tail may be absent */
  uint32_t reserved;
  /* [main] Ends the instance. Its parts are still alive. */
  void (*destroy)(void* self);
  /* [worker, concurrent] A table of optional abilities of this instance, or NULL; constant while the instance lives. The
   * function itself may be NULL: no extensions. */
  const void* (*extension)(const void* self, const char* id);
} plr_table_head;

/* A living instance. */
typedef struct plr_instance {
  void* self;
  const plr_table_head* table;
} plr_instance;

/* An instance that stands in a slot of another one. The holder calls it directly; the host is not in between. */
typedef struct plr_part {
  uint32_t struct_size;
  uint32_t value_count;
  const char* slot;    /* of the holder */
  const char* name;    /* the part's name within the slot; "" if unnamed */
  const char* address; /* `world.sensors.radar` */
  const char* table_id;
  const plr_description* description;
  plr_instance instance;
  const plr_value* values; /* [value_count] of the parameters that the slot declares */
} plr_part;

/* One input of one model in the tree below (and including) the instance that is being created. */
typedef struct plr_input_place {
  uint32_t struct_size;
  uint32_t size;
  const char* name; /* relative to this instance: `estimator.motion.normal` */
  const char* unit;
  int64_t offset; /* into plr_call.inputs */
  const double* defaults;
} plr_input_place;

/* Everything that an instance is made from. Valid while the instance lives. */
typedef struct plr_config {
  uint32_t struct_size;
  uint32_t value_count;
  const char* address;     /* `tracker.estimator.motion` */
  const plr_value* values; /* [value_count], in the order of the description */
  const plr_part* parts;   /* [part_count], slots in the order of the description, parts in the order of the file */
  uint32_t part_count;
  uint32_t input_count;
  const plr_input_place* inputs; /* [input_count] of the whole tree; its own come first */
  int64_t input_offset;          /* of its own inputs, in the order of the description, back to back */
  int64_t input_size;            /* doubles in plr_call.inputs */
  plr_key key;                   /* of (seed, run, node name): stages draw from it; models get keys in each call */
  const char* frame;             /* stages: the frame named in the config, or "" */
  const plr_host* host;
} plr_config;

/* What every plr_config has, of whatever version: create refuses a shorter one (PLR_E_ARGUMENT), and never asks for more. */
#define PLR_CONFIG_LEAST_SIZE (offsetof(plr_config, host) + sizeof(const plr_host*))

typedef struct plr_plugin {
  uint32_t struct_size;
  uint32_t reserved;
  const plr_description* description;
  const char* table_id;
  /* [main] Makes an instance. On failure nothing is left behind and error.where names the parameter or slot. */
  plr_status (*create)(const plr_config* config, plr_instance* out, plr_error* error);
} plr_plugin;

#endif

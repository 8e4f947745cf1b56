/* Pelorus ABI: the one symbol that a library exports, and the manifest that is read without loading it.
 *
 * `plr_entry` is data, not a function: the host compares abi_major before any code of the plugin has run. Static
 * constructors that register something would have run by then: have none.
 *
 * The manifest repeats the facts in the ELF section `pelorus`: an array of plr_manifest, one for each plugin of the library.
 * With it, a host that looks for one plugin among a thousand libraries opens that one alone.
 *
 * Ids: a table that reads `pelorus.KIND/1` is frozen for ever; a change is `/2`, beside it, and the host serves both. What a
 * later minor brings in as new stands as `pelorus.KIND.draft/N` at first: it may change, N is then raised, and the host refuses every other.
 */
#ifndef PELORUS_ABI_ENTRY_H
#define PELORUS_ABI_ENTRY_H

#include "plugin.h"

#define PLR_MANIFEST_SECTION "pelorus"
#define PLR_MANIFEST_MAGIC "PELORUS"

typedef struct plr_manifest {
  char magic[8]; /* "PELORUS" */
  uint32_t struct_size;
  uint16_t abi_major, abi_minor;
  char id[128];
  char kind[32];
  char table_id[56];
  char version[24];
} plr_manifest;

typedef struct plr_entry_point {
  uint32_t struct_size;
  uint16_t abi_major, abi_minor;
  /* [main] Once, before the first factory call; may be NULL. */
  plr_status (*init)(const plr_host* host, plr_error* error);
  /* [main] Once, at the end of the process, if init succeeded; may be NULL. */
  void (*deinit)(void);
  /* [main] The plugin of that id, or NULL. Valid for ever: libraries are not unloaded. */
  const plr_plugin* (*factory)(const char* id);
} plr_entry_point;

#define PLR_ENTRY_SYMBOL "plr_entry"
#define PLR_EXPORT __attribute__((visibility("default")))

#define PLR_JOIN_(a, b) a##b
#define PLR_JOIN(a, b) PLR_JOIN_(a, b)

/* In C, one line a plugin at file scope:
 *     PLR_MANIFEST("org.example.motion.mine", "motion", PLR_MOTION, "1.0.0");
 * and once a library:
 *     PLR_EXPORT const plr_entry_point plr_entry = {sizeof plr_entry, PLR_ABI_MAJOR, PLR_ABI_MINOR, NULL, NULL, factory};
 */
#define PLR_MANIFEST(id_, kind_, table_id_, version_)                                      \
  __attribute__((section(PLR_MANIFEST_SECTION), used)) static const plr_manifest PLR_JOIN( \
      plr_manifest_, __COUNTER__) = {PLR_MANIFEST_MAGIC,                                   \
                                     (uint32_t)sizeof(plr_manifest),                       \
                                     PLR_ABI_MAJOR,                                        \
                                     PLR_ABI_MINOR,                                        \
                                     id_,                                                  \
                                     kind_,                                                \
                                     table_id_,                                            \
                                     version_}

PLR_EXTERN_C_BEGIN
extern PLR_EXPORT const plr_entry_point plr_entry;
PLR_EXTERN_C_END

#endif

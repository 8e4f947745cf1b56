/* Pelorus ABI: records that outlive the plugin that wrote them (snapshots, tracks with records).
 *
 * A record's layout carries a version. A holder whose record nests others answers, as its own version, the fold of its own and
 * of its parts' versions by plr_mix_version, in the order in which they nest: so a change of any part's layout is seen from
 * outside. A record of another version is converted by this extension of the instance, or refused by name.
 */
#ifndef PELORUS_ABI_RECORD_H
#define PELORUS_ABI_RECORD_H

#include "call.h"

#define PLR_RECORD_CONVERT "pelorus.record.convert/1"

typedef struct plr_record_convert {
  uint32_t struct_size;
  uint32_t reserved;
  /* [worker, concurrent] Records of an older version, rows x 1 x N, to today's. PLR_E_STATE_VERSION: not that one. */
  plr_status (*convert)(const void* self, const plr_call* call, uint32_t from_version, const plr_const_view* in,
                        const plr_view* out);
} plr_record_convert;

static inline uint32_t plr_mix_version(uint32_t version, uint32_t of_part) {
  return version * UINT32_C(16777619) + of_part;
}

#endif

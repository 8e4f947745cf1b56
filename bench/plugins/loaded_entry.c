/* One of the fifty libraries: LOADED_ID, with the code of loaded_model.cpp. */
#include <pelorus/abi/abi.h>

const plr_plugin* loaded_model(const char* id, const char* wanted);

PLR_MANIFEST(LOADED_ID, "motion", PLR_MOTION, "1.0.0");

static const plr_plugin* factory(const char* wanted) { return loaded_model(LOADED_ID, wanted); }

PLR_EXPORT const plr_entry_point plr_entry = {sizeof plr_entry, PLR_ABI_MAJOR, PLR_ABI_MINOR, NULL, NULL, factory};

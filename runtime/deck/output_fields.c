#include "runtime/deck/output_fields.h"

#include <string.h>
#include <strings.h>

#include "runtime/base/symmetric_tensor.h"

bool output_is_component(const char *name, int dimensions) {
#define X(tensor, unit, words, of_nodes) #tensor "_",
  static const char *const begins[] = {OUTPUT_TENSORS(X)};
#undef X
  for (size_t k = 0; k < sizeof begins / sizeof *begins; k++) {
    const size_t length = strlen(begins[k]);
    if (strncasecmp(name, begins[k], length) == 0 && tensor_find(dimensions, name + length) >= 0)
      return true;
  }
  return false;
}

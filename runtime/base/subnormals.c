#include "runtime/base/subnormals.h"

#if defined(__SSE2__)
#include <xmmintrin.h>

enum { FLUSH_TO_ZERO = 0x8000, DENORMALS_ARE_ZERO = 0x0040 };

unsigned subnormals_off(void) {
  unsigned before = _mm_getcsr();
  _mm_setcsr(before | FLUSH_TO_ZERO | DENORMALS_ARE_ZERO);
  return before;
}

void subnormals_restore(unsigned before) {
  _mm_setcsr(before);
}
#elif defined(__aarch64__)
#include <stdint.h>

unsigned subnormals_off(void) {
  uint64_t before;
  __asm__ volatile("mrs %0, fpcr" : "=r"(before));
  __asm__ volatile("msr fpcr, %0" : : "r"(before | (UINT64_C(1) << 24)));
  return (unsigned)before;
}

void subnormals_restore(unsigned before) {
  __asm__ volatile("msr fpcr, %0" : : "r"((uint64_t)before));
}
#else
unsigned subnormals_off(void) {
  return 0;
}
void subnormals_restore(unsigned before) {
  (void)before;
}
#endif

/* C++ hosts link what public headers declare as C: each has its declarations between these two. */
#ifndef PERILAT_DSL_C_LINKAGE_H
#define PERILAT_DSL_C_LINKAGE_H

#ifdef __cplusplus
#define C_LINKAGE_BEGIN extern "C" {
#define C_LINKAGE_END   }
#else
#define C_LINKAGE_BEGIN
#define C_LINKAGE_END
#endif

#endif

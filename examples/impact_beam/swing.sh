#!/bin/bash
# Rms of the force of the left support about its mean over seven samples, from the start of the crack on:
#     bash swing.sh updates_study/*.h5
perilat=${PERILAT:-perilat}
for result in "$@"; do
  start=$("$perilat" export --history midspan/speed "$result" | awk -F, '$2 > 0 && $1 + 0 > 0 { print $1; exit }')
  "$perilat" export --history left_support "$result" |
    awk -F, -v start="${start:-1e9}" -v name="$result" '
      NR > 1 { t[++n] = $1; f[n] = $2 }
      END {
        for (k = 4; k <= n - 3; k++) {
          if (t[k] < start) continue
          mean = 0
          for (i = -3; i <= 3; i++) mean += f[k + i] / 7
          sum += (f[k] - mean) ^ 2; count++
        }
        if (count) printf "%s: %.1f N\n", name, sqrt(sum / count)
        else printf "%s: the crack does not grow\n", name
      }'
done

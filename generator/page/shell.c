#include "generator/page/shell.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/sha256.h"
#include "generator/page/assets.h"
#include "generator/page/html.h"
#include "generator/page/packing.h"
#include "runtime/base/whole_file.h"

/* As a policy names an inline text: 'sha256-...'. */
static void put_hash(FILE *out, const char *text) {
  sha256 h;
  unsigned char digest[SHA256_SIZE];
  sha256_begin(&h);
  sha256_add(&h, text, strlen(text));
  sha256_end(&h, digest);
  char *code = packing_base64(digest, sizeof digest);
  fprintf(out, "'sha256-%s'", code);
  free(code);
}

static void put_policy(FILE *out) {
  fputs("<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src ",
        out);
  put_hash(out, page_script);
  fputs("; style-src ", out);
  put_hash(out, page_style);
  fputs("; img-src data:; base-uri 'none'; form-action 'none'\"/>\n", out);
}

void shell_begin(FILE *out, const char *title) {
  fputs("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n", out);
  put_policy(out);
  fputs("<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n"
        "<meta name=\"referrer\" content=\"no-referrer\"/>\n<title>",
        out);
  html_text(out, title);
  fprintf(out,
          "</title>\n<link rel=\"icon\" href=\"data:,\"/>\n<style>%s</style>\n</head>\n<body>\n",
          page_style);
}

/* In a script element only `<` could end it, and in JSON it stands in texts alone. */
static void put_data(FILE *out, const char *data) {
  for (; *data; data++)
    if (*data == '<')
      fputs("\\u003c", out);
    else
      fputc(*data, out);
}

void shell_end(FILE *out, const char *data) {
  if (data) {
    fputs("<script type=\"application/json\" id=\"data\">", out);
    put_data(out, data);
    fprintf(out, "</script>\n<script>%s</script>\n", page_script);
  }
  fputs("</body>\n</html>\n", out);
}

bool shell_write(const char *path, const char *text, size_t length, char *error, size_t size) {
  whole_file file;
  FILE *out = whole_file_open(&file, path);
  bool good = out && fwrite(text, 1, length, out) == length;
  good = out && fclose(out) == 0 && good;
  good = out && whole_file_end(&file, good);
  if (!good) snprintf(error, size, "cannot write `%s`: %s", path, strerror(errno));
  return good;
}

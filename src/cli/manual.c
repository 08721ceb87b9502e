#include "base/version.h"
#include "cli/generate.h"
#include "cli/log.h"

#include <ctype.h>
#include <string.h>

/* Writes a text for man: a minus would become a hyphen, and a dot at the start of a line a command.
 */
static void put(FILE *out, const char *text) {
    bool start = true;
    for (; *text; text++) {
        if (start && (*text == '.' || *text == '\'')) fputs("\\&", out);
        if (*text == '-')
            fputs("\\-", out);
        else if (*text == '\\')
            fputs("\\e", out);
        else
            fputc(*text, out);
        start = *text == '\n';
    }
}

static void put_entry(FILE *out, const char *name, const char *text) {
    fputs(".TP\n.B ", out);
    put(out, name);
    fputc('\n', out);
    put(out, text);
    fputc('\n', out);
}

static void print_title(FILE *out, const char *name) {
    fputs(".TH GNEISS", out);
    if (*name) fputs("\\-", out);
    for (; *name; name++) fputc(toupper((unsigned char)*name), out);
    fprintf(out, " 1 \"\" \"gneiss %s\" \"User Commands\"\n", gn_version());
}

static void print_options(FILE *out, const gn_command *command) {
    bool any = false;
    for (const gn_option_text *o = gn_option_texts; o->name; o++) {
        if (command && !gn_command_takes(command, o)) continue;
        if (!any) fputs(".SH OPTIONS\n", out);
        any = true;
        put_entry(out, o->name, *o->text ? o->text : "this text; the version");
    }
}

static void print_exit_codes(FILE *out) {
    char number[16];
    fputs(".SH \"EXIT STATUS\"\n", out);
    for (int code = 0; gn_exit_code_text(code); code++) {
        snprintf(number, sizeof number, "%d", code);
        put_entry(out, number, gn_exit_code_text(code));
    }
}

static void print_one(FILE *out, const gn_command *command) {
    print_title(out, command->name);
    fprintf(out, ".SH NAME\ngneiss\\-%s \\- ", command->name);
    put(out, command->text);
    fprintf(out, "\n.SH SYNOPSIS\n.B gneiss %s\n%s [options]\n", command->name, command->arguments);
    if (*command->more) {
        fputs(".SH DESCRIPTION\n", out);
        put(out, command->more);
    }
    print_options(out, command);
    print_exit_codes(out);
    fputs(".SH EXAMPLES\n.nf\n", out);
    put(out, command->examples);
    fputs(".fi\n.SH \"SEE ALSO\"\n.BR gneiss (1)\n", out);
}

void gn_print_manual(FILE *out, const gn_command *command) {
    char name[64];
    if (command) {
        print_one(out, command);
        return;
    }
    print_title(out, "");
    fputs(".SH NAME\ngneiss \\- bonded discrete and finite elements for rock and concrete\n"
          ".SH SYNOPSIS\n.B gneiss\nCOMMAND [options]\n.SH COMMANDS\n",
          out);
    for (size_t k = 0; gn_command_at(k); k++) {
        snprintf(name, sizeof name, "%s %s", gn_command_at(k)->name, gn_command_at(k)->arguments);
        put_entry(out, name, gn_command_at(k)->text);
    }
    print_options(out, NULL);
    print_exit_codes(out);
    fputs(".SH \"SEE ALSO\"\n", out);
    for (size_t k = 0; gn_command_at(k); k++)
        fprintf(out, ".BR gneiss\\-%s (1)%s\n", gn_command_at(k)->name,
                gn_command_at(k + 1) ? "," : "");
}

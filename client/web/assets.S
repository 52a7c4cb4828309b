// The bytes of the files of the page: each file as NAME, and its end as NAME_end.
        .section .rodata

        .macro asset name, file
        .global \name, \name\()_end
\name:
        .incbin "\file"
\name\()_end:
        .byte 0
        .endm

#define WEB_FILE(name, path, type, file) asset name, file
#include "web_files.inc"

        .section .note.GNU-stack, "", %progbits

// The files of the page, each compressed with gzip. server/network/web_assets.cpp declares their names.
        .section .rodata

        .macro asset name, file
        .global \name, \name\()_end
\name:
        .incbin "\file"
\name\()_end:
        .byte 0
        .endm

        asset evod_web_index_html, "index.html.gz"
        asset evod_web_app_css, "app.css.gz"
        asset evod_web_page_js, "page.js.gz"
        asset evod_web_shared_js, "shared.js.gz"
        asset evod_web_panels_js, "panels.js.gz"
        asset evod_web_worker_js, "worker.js.gz"

        .section .note.GNU-stack, "", %progbits

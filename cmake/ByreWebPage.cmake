# Embeds the viewer's page, built from web/ by scripts/build-web.sh and stored in the repository: building byre needs no
# npm, and the program needs no installed page.
function(byre_embed_web_page)
  set(page ${CMAKE_CURRENT_SOURCE_DIR}/web/dist/index.html)
  set_source_files_properties(src/byre/viewer/web/web_page.cc PROPERTIES COMPILE_DEFINITIONS "BYRE_WEB_PAGE=\"${page}\""
                              OBJECT_DEPENDS ${page})
endfunction()

# The viewer's page is compiled in, from the file that scripts/build-web.sh makes of web/ and that is kept beside its
# source: building byre needs no npm, and the program finds its page wherever it is installed.
function(byre_embed_web_page)
  set(page ${CMAKE_CURRENT_SOURCE_DIR}/web/dist/index.html)
  set_source_files_properties(src/byre/viewer/web_page.cc PROPERTIES COMPILE_DEFINITIONS "BYRE_WEB_PAGE=\"${page}\""
                              OBJECT_DEPENDS ${page})
endfunction()

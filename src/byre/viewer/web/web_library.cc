// Compiles Asio and Beast once: BOOST_ASIO_SEPARATE_COMPILATION and BOOST_BEAST_SEPARATE_COMPILATION are set for this
// folder.
#include <boost/asio/impl/src.hpp>
#include <boost/beast/src.hpp>

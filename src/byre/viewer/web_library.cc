// What Asio and Beast would else compile in each file that includes them: their macros BOOST_ASIO_SEPARATE_COMPILATION
// and BOOST_BEAST_SEPARATE_COMPILATION are set for this room.
#include <boost/asio/impl/src.hpp>
#include <boost/beast/src.hpp>

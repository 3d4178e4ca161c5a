#!/usr/bin/env bash
# Starts a PostgreSQL server of Debian in a folder, for tests and for trying out byre registry. It listens only on
# a socket in the folder, without passwords; a registry for robots needs a server with TLS and passwords.
# Prints the settings of the environment by which clients find it. Root starts it as the user postgres.
# Usage: registry.sh FOLDER [start | stop | kill]
#   start   makes the server and the database byre unless they are there, and starts it (default)
#   stop    ends the server; the data stay
#   kill    ends its processes by SIGKILL, as a power failure does
# Exit code 77: no PostgreSQL is installed.
set -euo pipefail

fail() { echo "registry.sh: $1" >&2; exit "${2:-1}"; }
[[ $# -ge 1 && $# -le 2 && ${2:-start} =~ ^(start|stop|kill)$ ]] || fail "usage: registry.sh FOLDER [start | stop | kill]" 2
[[ -d $1 ]] || { mkdir -p "$1" && chmod 711 "$1"; }
folder=$(cd "$1" && pwd)
action=${2:-start}

programs=$(find /usr/lib/postgresql -maxdepth 2 -name bin 2>/dev/null | sort -V | tail -n 1)
[[ -n $programs && -x $programs/pg_ctl ]] || fail "no PostgreSQL in /usr/lib/postgresql (install postgresql)" 77
((${#folder} <= 80)) || fail "$folder is too long for the name of a socket (choose a shorter folder)"

data=$folder/data socket=$folder/socket
as_owner=()
owner=$(id --user --name)
if ((EUID == 0)); then
  owner=postgres
  as_owner=(setpriv --reuid=postgres --regid=postgres --init-groups --inh-caps=-all)
fi
[[ $("${as_owner[@]}" test -x "$folder" && echo yes) == yes ]] ||
  fail "$owner may not enter $folder (choose a folder that all may enter, such as one in /tmp)"
pg() { (cd / && "${as_owner[@]}" env -u PGPORT -u PGUSER PGHOST="$socket" "$programs/$1" "${@:2}"); }

case $action in
  start)
    if [[ ! -e $data/PG_VERSION ]]; then
      mkdir -p "$data" "$socket"
      chmod 700 "$data" "$socket"
      if ((EUID == 0)); then chown postgres: "$data" "$socket"; fi
      pg initdb --pgdata="$data" --auth=trust --encoding=UTF8 --locale=C.UTF-8 --username="$owner" \
        >"$folder/initdb.log" 2>&1 || fail "the database cannot be made, see $folder/initdb.log"
      printf '%s\n' "listen_addresses = ''" "unix_socket_directories = '${socket//\'/\'\'}'" "max_connections = 200" \
        >>"$data/postgresql.conf"
    fi
    if ! pg pg_ctl --pgdata="$data" status >/dev/null 2>&1; then
      pg pg_ctl --pgdata="$data" --wait --timeout=60 --log="$data/server.log" start >/dev/null ||
        fail "the server does not start, see $data/server.log"
    fi
    exists=$(pg psql --dbname=postgres --username="$owner" --no-psqlrc --tuples-only --no-align \
      --command="SELECT 1 FROM pg_database WHERE datname = 'byre'")
    [[ $exists == 1 ]] || pg createdb --username="$owner" byre
    printf 'export PGHOST=%q PGDATABASE=byre PGUSER=%q\n' "$socket" "$owner"
    ;;
  stop) pg pg_ctl --pgdata="$data" --mode=fast --wait stop >/dev/null ;;
  kill)
    postmaster=$(head -n 1 "$data/postmaster.pid")
    workers=$(ps --no-headers --format pid --ppid "$postmaster" || true)
    # shellcheck disable=SC2086
    kill -9 "$postmaster" $workers
    # The next start fails while one of them runs. Zombies, which their parent does not wait for, count as ended.
    for process in $postmaster $workers; do
      while [[ $(ps --no-headers --format state --pid "$process") == [^Z]* ]]; do sleep 0.01; done
    done
    rm -f "$data/postmaster.pid" "$socket"/.s.PGSQL.*
    ;;
esac

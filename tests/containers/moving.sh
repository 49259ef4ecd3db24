# Scenarios: a newer image, a backup brought elsewhere. Sourced by composition_test.sh.

# The composition rolls to an image with another version; its survey and its keys are there.
rolled_to_a_newer_image() {
  local before points
  points=$(demo_points) before=$(container_of wayfused)
  printf 'FROM wayfuse-test/server\nLABEL org.opencontainers.image.version=99.0.0\n' | docker build -q -t "$SERVER_IMAGE" - >/dev/null 2>&1
  compose up -d --no-build wayfused >/dev/null 2>&1
  [ "$(container_of wayfused)" != "$before" ] || die "the newer image was not taken up"
  wait_for 60 "rolled to the newer image" ready
  [ "$(demo_points)" = "$points" ] || die "points before $points, after $(demo_points)"
  ok "all $points points and the keys are there"
}

# A database as the first release wrote it: migrated at the start, a copy kept, the survey whole.
an_old_database_is_migrated() {
  local fixture="$SOURCE/tests/db/fixtures/building-v1.sqlite" expected found
  expected=$(sqlite3 -readonly "$fixture" 'SELECT count(*) FROM reference_point')
  docker volume create "$PROJECT-old" >/dev/null
  docker run --rm -i -v "$PROJECT-old:/journals" wayfuse-test/tests sh -c 'cat >/journals/building-7.sqlite' <"$fixture"
  begin_lone_server old "$PROJECT-old" wayfuse-test/server
  found=$(operator --json building show 7 | sed -n 's/.*"points":\([0-9]*\).*/\1/p')
  [ "$found" = "$expected" ] || die "the old database has $expected points, the migrated one $found"
  docker exec "$LONE" test -s /var/lib/wayfuse/building-7.sqlite.v1 || die "no copy was kept before the migration"
  ok "a database of the first schema is migrated, its $expected points are there, a copy is kept"
  end_lone_server
}

# A backup taken while surveyors write, brought into another container: every batch acknowledged before it is in it, the keys work.
backed_up_and_restored_elsewhere() {
  local building
  building=$(new_building "Moving house")
  begin_surveying move "$building" 2
  wait_for 60 "surveyors upload" acks_beyond move 50
  in_journals "mkdir /journals/moved && cat /journals/move/*.journal | grep ^acked >/journals/moved/2-acked.journal"
  docker run --rm -v "${PROJECT}_data:/data" -v "$PROJECT-restored:/journals" wayfuse-test/tests \
    sh -ec "for file in server building-$building; do sqlite3 /data/\$file.sqlite \".backup /journals/\$file.sqlite\"; done" || die "the backup failed"
  operator backup "$building" /journals/moved/by-hand.sqlite >/dev/null || die "wayfuse backup failed"
  ok "backed up while surveyors write"
  end_surveying move
  begin_lone_server restored "$PROJECT-restored" wayfuse-test/server
  operator building show "$building" >/dev/null || die "the restored server does not know building and key"
  in_journals "cat /journals/move/*.journal | grep ^sent >/journals/moved/1-sent.journal"
  nothing_lost "restored into another container" moved "$PROJECT-restored" "$building" ""
  end_lone_server
  docker volume create "$PROJECT-fresh" >/dev/null
  begin_lone_server fresh "$PROJECT-fresh" wayfuse-test/server
  operator restore /journals/moved/by-hand.sqlite >/dev/null || die "wayfuse restore failed"
  operator verify "$building" >/dev/null || die "the restored building does not verify"
  nothing_lost "restored by the command line into a fresh server" moved "$PROJECT-fresh" "$building" ""
  end_lone_server
}

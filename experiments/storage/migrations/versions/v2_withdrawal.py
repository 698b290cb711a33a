"""Withdrawal: only the answers of someone who withdrew may be erased, and no more come after."""

import sqlalchemy as sa
from alembic import op

revision = "2"
down_revision = "1"

_KEPT = ("responses", "events")

_SQLITE_RULES = (
    """
CREATE TRIGGER {table}_refuse_update BEFORE UPDATE ON {table}
BEGIN SELECT RAISE(ABORT, '{table} are never changed'); END
""",
    """
CREATE TRIGGER {table}_refuse_delete BEFORE DELETE ON {table}
WHEN (SELECT withdrawn_at FROM sessions WHERE id = OLD.session) IS NULL
BEGIN SELECT RAISE(ABORT, '{table} are never changed'); END
""",
)
_SQLITE_RULE_ON_WITHDRAWN = """
CREATE TRIGGER responses_refuse_withdrawn BEFORE INSERT ON responses
WHEN (SELECT withdrawn_at FROM sessions WHERE id = NEW.session) IS NOT NULL
BEGIN SELECT RAISE(ABORT, 'the session was withdrawn'); END
"""

_POSTGRESQL_RULES = """
CREATE FUNCTION refuse_change() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
    IF TG_OP = 'DELETE' THEN
        PERFORM FROM sessions WHERE id = OLD.session AND withdrawn_at IS NOT NULL;
        IF FOUND THEN RETURN OLD; END IF;
    END IF;
    RAISE integrity_constraint_violation
        USING MESSAGE = TG_TABLE_NAME || ' are never changed';
END $$;
CREATE FUNCTION refuse_withdrawn() RETURNS trigger LANGUAGE plpgsql AS $$
DECLARE withdrawn varchar;
BEGIN
    -- The lock waits for a withdrawal under way, which holds the session FOR UPDATE.
    SELECT withdrawn_at INTO withdrawn FROM sessions WHERE id = NEW.session FOR KEY SHARE;
    IF withdrawn IS NULL THEN RETURN NEW; END IF;
    RAISE integrity_constraint_violation USING MESSAGE = 'the session was withdrawn';
END $$;
CREATE TRIGGER responses_refuse_withdrawn BEFORE INSERT ON responses
    FOR EACH ROW EXECUTE FUNCTION refuse_withdrawn();
"""
_POSTGRESQL_TRIGGERS = """
CREATE TRIGGER {table}_refuse_change BEFORE UPDATE OR DELETE ON {table}
    FOR EACH ROW EXECUTE FUNCTION refuse_change();
CREATE TRIGGER {table}_refuse_truncate BEFORE TRUNCATE ON {table}
    FOR EACH STATEMENT EXECUTE FUNCTION refuse_change();
"""


def upgrade() -> None:
    """Add the time of withdrawal, and make the rules the database's own."""
    op.add_column("sessions", sa.Column("withdrawn_at", sa.String))
    if op.get_context().dialect.name == "sqlite":
        for change in ("UPDATE", "DELETE"):
            op.execute(f"DROP TRIGGER responses_refuse_{change}")
        for table in _KEPT:
            for rule in _SQLITE_RULES:
                op.execute(rule.format(table=table))
        op.execute(_SQLITE_RULE_ON_WITHDRAWN)
    else:
        op.execute(_POSTGRESQL_RULES)
        for table in _KEPT:
            op.execute(_POSTGRESQL_TRIGGERS.format(table=table))
    # The first Trompe knows no revisions: this is where it finds that the store is none of its.
    op.execute("DELETE FROM settings WHERE key = 'schema'")
    op.execute(f"INSERT INTO settings (key, value) VALUES ('schema', '{revision}')")

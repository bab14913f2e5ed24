(* Theorem 4 at crossings: two shielded vehicles that count on precedence are never in a crossing together. *)
Require Import Reals Lra Lia Psatz List.
Require Import Contract Shipped Motion Reach Statement Ego Plan Apart Entry Shield.
Open Scope R_scope.

(* A plan that counts on a claim that is gone no longer moves its vehicle: seen at rest so long after the claim, it has no go
   left, and it brakes. *)
Lemma brakes_already k r t w tau c l x from j0 j u :
  valid k -> 0 <= r < unheld k -> motion t w -> on_grid k tau -> obeys k w tau c -> true_log k l t w tau c ->
  (1 <= j0 <= j)%nat -> (forall q, (j0 <= q < j)%nat -> carries_on k l c q) ->
  w x <= r -> tau (S j0) + switching k + r / ego_go k < x ->
  x + switching k <= from -> from <= u <= tau (S j) -> speeds_up_at_most w (- ego_braking k) from u.
Proof.
  intros ok [r0 slow] m grid obey true [a1 a2] carried rest late settled [lo hi].
  pose proof (forwards t w m) as pos.
  assert (g0 : 0 < ego_go k) by (destruct ok; lra).
  destruct j0 as [| j1]; [lia |].
  pose proof (plan_is_followed k w tau c ok pos grid obey l) as F.
  assert (knows : forall i, own_v (ego_at l (S i)) <= w (tau (S i)) + speed_error k /\ previous_most l (S i) <= ego_acceleration k).
  { intros i. destruct (true i) as ((_ & [? _] & _) & _ & ?). lra. }
  specialize (F knows j1 (j - S j1)%nat). destruct (true j1) as (_ & prev & _). specialize (F prev).
  specialize (F ltac:(intros q hq; apply carried; lia)).
  replace (S (S j1) + (j - S j1))%nat with (S j) in F by lia.
  destruct (switching_fits k ok) as [[sw0 sw] sp].
  pose proof (spacing k tau grid (S j1) 1) as [next _]. replace (S j1 + 1)%nat with (S (S j1)) in next by lia. simpl INR in next.
  assert (tau (S j1) + shortest_period k <= tau (S (S j1))) by (unfold shortest_period; lra).
  set (T := tau (S j1)) in *. set (n := goes l (S j1)) in *.
  assert (rg : 0 <= r / ego_go k) by (apply Rmult_le_pos; [lra | left; apply Rinv_0_lt_compat; lra]).
  assert (gone : T + shortest_period k + INR n * period k < x).
  { destruct (Rlt_le_dec (T + shortest_period k + INR n * period k) x) as [? | going]; [assumption | exfalso].
    pose proof (down4 k w T (tau (S j)) _ _ _ n F x ltac:(lra) ltac:(lra)) as fast.
    specialize (fast (T + shortest_period k + switching k) x ltac:(lra) ltac:(lra) ltac:(lra)).
    pose proof (pos (T + shortest_period k + switching k)) as p0. set (v0 := w (T + shortest_period k + switching k)) in *.
    assert (more : r < ego_go k * (x - (T + shortest_period k + switching k))).
    { replace r with (ego_go k * (r / ego_go k)) at 1 by (field; lra). apply Rmult_lt_compat_l; lra. }
    revert fast. cases; lra. }
  pose proof (up5 k w T (tau (S j)) _ _ _ n F u ltac:(lra)) as brakes_.
  intros p q ? ? ?. apply brakes_; lra.
Qed.

(* Two that count on precedence at one time: the one whose claim is older rests where the other, at call i0 of its shield, was
   sure that it can. *)
Lemma older_rests k r t w tau i0 tau' c' l' j0 j u bounds limit :
  valid k -> precedence_braking k <= ego_braking k -> 0 <= r < unheld k -> motion t w ->
  on_grid k tau' -> obeys k w tau' c' -> true_log k l' t w tau' c' ->
  hold bounds (t (tau i0)) (w (tau i0)) ->
  rest_of {| distance := t_most bounds; speed := w_most bounds |} (precedence_braking k) <= limit ->
  (1 <= j0 <= j)%nat -> (forall q, (j0 <= q < j)%nat -> carries_on k l' c' q) -> tau i0 <= u <= tau' (S j) ->
  newer k r tau i0 tau' j0 w -> t u <= limit.
Proof.
  intros ok P6 rest m grid obey true [tT wT] stop first carried hu (x & x' & slow & _ & late & seen_).
  pose proof (forwards t w m (tau i0)) as w0.
  assert (p0 : 0 < precedence_braking k) by (destruct ok; lra).
  assert (b0 : 0 < ego_braking k) by (destruct ok; lra).
  pose proof (brakes_already k r t w tau' c' l' x (tau i0) j0 j u ok rest m grid obey true first carried
                slow late ltac:(lra) hu) as B.
  pose proof (stops_by t w (ego_braking k) (w (tau i0)) (tau i0) u m b0 (proj1 hu) B (Rle_refl _)) as S.
  unfold rest_of in stop. cbn in stop.
  assert (w (tau i0) * w (tau i0) / (ego_braking k + ego_braking k)
          <= w_most bounds * w_most bounds / (precedence_braking k + precedence_braking k)); [| lra].
  apply Rle_trans with (w (tau i0) * w (tau i0) / (precedence_braking k + precedence_braking k)).
  - apply Rmult_le_compat_l; [apply Rmult_le_pos; lra | apply Rinv_le_contravar; lra].
  - apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat; lra | apply Rmult_le_compat; lra].
Qed.

(* At a crossing it stays out. *)
Lemma older_stays_out k r z judges s v t w claimed tau c l b since tau' c' l' i0 i j0 j u :
  valid k -> precedence_braking k <= ego_braking k -> 0 <= r < unheld k -> motion t w ->
  watches k judges s v t w tau c l b since ->
  on_grid k tau' -> obeys k w tau' c' -> true_log k l' t w tau' c' ->
  (since <= i0 <= i)%nat -> opened_at k b z claimed i0 -> tau i <= u ->
  (1 <= j0 <= j)%nat -> (forall q, (j0 <= q < j)%nat -> carries_on k l' c' q) -> u <= tau' (S j) ->
  newer k r tau i0 tau' j0 w -> ~ inside z (s u) (t u).
Proof.
  intros ok P6 rest mt W grid' obey' true' [h1 h2] [_ stop] lo first carried hi new_ (_ & [tin _] & _).
  destruct (known_holds k t w (tau since) (tau i0) (b i0) ok mt (its_other _ _ _ _ _ _ _ _ _ _ _ W)
              (its_view _ _ _ _ _ _ _ _ _ _ _ W i0 h1)) as [_ B].
  pose proof (calls_ordered k tau ok (its_calls _ _ _ _ _ _ _ _ _ _ _ W) i0 i h2).
  pose proof (older_rests k r t w tau i0 tau' c' l' j0 j u (b i0) (t_in z) ok P6 rest mt grid' obey' true' B stop first carried
                ltac:(lra) new_). lra.
Qed.

(* A zone that is judged without precedence. *)
Lemma judged_alone k z s v t w claimed tau c l b since i u :
  valid k -> lane z = false -> motion s v -> motion t w ->
  watches k (judged k l c b z claimed since) s v t w tau c l b since ->
  (since <= i)%nat -> tau i <= u <= tau (S i) ->
  (exists i0, (since <= i0 <= i)%nat /\ opened_at k b z claimed i0 /\ forall q, (i0 <= q < i)%nat -> carries_on k l c q) \/
  ~ inside z (s u) (t u).
Proof.
  intros ok la ms mt [grid obey true keeps view start judges] h hu.
  destruct (judges i h) as [? | [? | [? | (i0 & r1 & open & carried)]]];
    [right | right | right | left; exists i0; auto].
  all: apply (judged_safe k s v tau c l) with (w := w) (b := b) (claimed := fun _ => False) (since := since) (i := i);
    auto; try (rewrite la; discriminate); try (intros a d _ []); unfold judged; auto.
Qed.

Lemma mirrored_back z y : mirrored z y -> mirrored y z.
Proof. unfold mirrored. lra. Qed.

Lemma inside_mirrored z y s t : mirrored z y -> inside z s t -> inside y t s.
Proof. unfold mirrored, inside. lra. Qed.

Theorem precedence_is_safe_at_crossings : Theorem4_crossing.
Proof.
  intros k r z y s v t w claimed tau c l b since claimed' tau' c' l' b' since' ok P6 rest lz ly mir ms mt W W' order u lo ins.
  assert (lo1 : tau since <= u) by (apply Rle_trans with (2 := lo); apply Rmax_l).
  assert (lo2 : tau' since' <= u) by (apply Rle_trans with (2 := lo); apply Rmax_r).
  pose proof (inside_mirrored z y (s u) (t u) mir ins) as ins'.
  destruct (between_calls k tau ok (its_calls _ _ _ _ _ _ _ _ _ _ _ W) since u lo1)
    as (i & hi & hu).
  destruct (between_calls k tau' ok (its_calls _ _ _ _ _ _ _ _ _ _ _ W') since' u lo2)
    as (j & hj & hu').
  destruct (judged_alone k z s v t w claimed tau c l b since i u ok lz ms mt W hi hu) as [(i0 & r1 & open & carried) | ?];
    [| contradiction].
  destruct (judged_alone k y t w s v claimed' tau' c' l' b' since' j u ok ly mt ms W' hj hu') as [(j0 & r1' & open' & carried') | ?];
    [| contradiction].
  pose proof (its_start _ _ _ _ _ _ _ _ _ _ _ W). pose proof (its_start _ _ _ _ _ _ _ _ _ _ _ W').
  destruct (order i0 j0 (proj1 r1) open (proj1 r1') open') as [n | n].
  - apply (older_stays_out k r z (judged k l c b z claimed since) s v t w claimed tau c l b since tau' c' l' i0 i j0 j u); auto; try apply W'; try lra; lia.
  - apply (older_stays_out k r y (judged k l' c' b' y claimed' since') t w s v claimed' tau' c' l' b' since' tau c l j0 j i0 i u);
      auto; try apply W; try lra; lia.
Qed.
